//! A 64-bit hash of a world's state, to compare two runs.

use glam::{DQuat, DVec3};

use super::World;

impl World {
    /// A hash of the state that steps change: every bit of the positions, velocities and previous positions, of
    /// rotations and angular momenta, of time, steps and impacts, of the latest impact, and of the pairs that are
    /// still in overlap. Two worlds with the same setup and the same hash continue in the same way and report the
    /// same, except for a hash collision with probability 2^-64.
    ///
    /// The hash does not include the setup (forces, masses, shapes, settings), nor data that only saves time or
    /// explains an error. So it is the same for the naive search and the BVH, for any number of threads, with and
    /// without `std`, in debug and release builds.
    ///
    /// It is FNV-1a over 64-bit words in little-endian order: for comparisons, not for cryptography.
    ///
    /// ```
    /// # use sim_core::{Body, DVec3, Settings, World};
    /// let mut world = World::new(Settings::default())?;
    /// world.add(Body { velocity: DVec3::X, ..Body::default() })?;
    /// let mut twin = world.clone();
    /// world.step()?;
    /// assert_ne!(world.state_hash(), twin.state_hash());
    /// twin.step()?;
    /// assert_eq!(world.state_hash(), twin.state_hash());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn state_hash(&self) -> u64 {
        let mut hash = Fnv::new();
        hash.word(self.bodies.len() as u64);
        let columns = [
            &self.current.position,
            &self.current.velocity,
            &self.previous.position,
        ];
        for vector in columns.into_iter().flatten() {
            hash.vector(*vector);
        }
        for state in [&self.current, &self.previous] {
            for turned in &state.turned {
                let DQuat { x, y, z, w } = turned.rotation;
                [x, y, z, w].into_iter().for_each(|part| hash.number(part));
                hash.vector(turned.momentum);
            }
        }
        hash.number(self.time());
        hash.word(self.elapsed.steps);
        hash.word(self.record.impacts);
        hash.word(u64::from(self.record.last_impact.is_some()));
        if let Some(impact) = &self.record.last_impact {
            hash.word(impact.step);
            hash.number(impact.time);
            hash.pair(impact.bodies);
            hash.vector(impact.point);
            hash.vector(impact.normal);
            hash.number(impact.impulse);
            hash.number(impact.speeds.0);
            hash.number(impact.speeds.1);
        }
        let overlapping = self.overlapping();
        hash.word(overlapping.len() as u64);
        for &pair in overlapping {
            hash.pair(pair);
        }
        hash.0
    }
}

/// FNV-1a of 64 bits: Fowler, Noll, Vo, Eastlake, Hansen, "The FNV Non-Cryptographic Hash
/// Algorithm", draft-eastlake-fnv, section 2.
struct Fnv(u64);

impl Fnv {
    const BASIS: u64 = 0xcbf2_9ce4_8422_2325;
    const PRIME: u64 = 0x0000_0100_0000_01b3;

    fn new() -> Fnv {
        Fnv(Self::BASIS)
    }

    fn bytes(&mut self, bytes: &[u8]) {
        for byte in bytes {
            self.0 = (self.0 ^ u64::from(*byte)).wrapping_mul(Self::PRIME);
        }
    }

    fn word(&mut self, word: u64) {
        self.bytes(&word.to_le_bytes());
    }

    fn number(&mut self, number: f64) {
        self.word(number.to_bits());
    }

    fn vector(&mut self, vector: DVec3) {
        vector
            .to_array()
            .into_iter()
            .for_each(|part| self.number(part));
    }

    fn pair(&mut self, (i, j): (usize, usize)) {
        self.word(i as u64);
        self.word(j as u64);
    }
}

#[cfg(test)]
mod tests {
    use alloc::{vec, vec::Vec};

    use super::*;
    use crate::{Body, Collision, Force, Settings, Shape};

    #[test]
    fn it_is_fnv_1a() {
        // Known hashes of short texts.
        for (text, expected) in [
            ("", 0xcbf2_9ce4_8422_2325),
            ("a", 0xaf63_dc4c_8601_ec8c),
            ("foobar", 0x8594_4171_f739_67e8),
        ] {
            let mut hash = Fnv::new();
            hash.bytes(text.as_bytes());
            assert_eq!(hash.0, expected, "{text}");
        }
    }

    /// Three balls in a row, the first one moving, after some steps.
    fn balls(collision: Collision, steps: u32) -> World {
        let settings = Settings {
            collision,
            ..Settings::default()
        };
        let mut world = World::new(settings).unwrap();
        for i in 0..3 {
            let ball = Body {
                shape: Some(Shape::Sphere { radius: 0.5 }),
                position: DVec3::new(1.7 * f64::from(i), 0.1 * f64::from(i), 0.0),
                velocity: f64::from(3 * u32::from(i == 0)) * DVec3::X,
                ..Body::default()
            };
            world.add(ball).unwrap();
        }
        let drag = Force::LinearDrag {
            body: None,
            coefficient: 0.25,
        };
        world.add_force(drag).unwrap();
        for _ in 0..steps {
            world.step().unwrap();
        }
        world
    }

    #[test]
    fn every_bit_of_the_state_counts() {
        let world = balls(Collision::Continuous, 60);
        assert!(world.impacts() > 0);
        let hash = world.state_hash();
        let flip = |number: &mut f64| *number = f64::from_bits(number.to_bits() ^ 1);
        let mut changed: Vec<World> = Vec::new();
        for body in 0..3 {
            for axis in 0..3 {
                for column in 0..3 {
                    let mut other = world.clone();
                    let vector = match column {
                        0 => &mut other.current.position[body],
                        1 => &mut other.current.velocity[body],
                        _ => &mut other.previous.position[body],
                    };
                    flip(&mut vector[axis]);
                    changed.push(other);
                }
            }
        }
        let counts: [fn(&mut World); 5] = [
            |world| world.elapsed.steps += 1,
            |world| world.record.impacts += 1,
            |world| world.settings.dt *= 2.0,
            |world| world.record.last_impact = None,
            |world| world.overlaps.pairs.push((0, 1)),
        ];
        for change in counts {
            let mut other = world.clone();
            change(&mut other);
            changed.push(other);
        }
        let mut hashes: Vec<u64> = changed.iter().map(World::state_hash).collect();
        hashes.push(hash);
        let all = hashes.len();
        hashes.sort_unstable();
        hashes.dedup();
        assert_eq!(hashes.len(), all);
    }

    #[test]
    fn what_was_set_does_not_count_and_what_searches_neither() {
        let mut world = balls(Collision::Naive, 60);
        assert_eq!(
            world.state_hash(),
            balls(Collision::Bvh, 60).state_hash(),
            "the same way"
        );
        let hash = world.state_hash();
        world.build_bvhs();
        world.set_mass(0, 2.0).unwrap();
        world.set_force(0, DVec3::X).unwrap();
        assert_eq!(world.state_hash(), hash);
        assert_eq!(world.previous.velocity.len(), 3);
        world.previous.velocity = vec![DVec3::ZERO; 3];
        assert_eq!(world.state_hash(), hash, "no step reads it");
    }

    /// The hash is the same in every build: this test runs without `std` and with it, and `tests/hashes.rs` has the
    /// scenes of the gallery.
    #[test]
    fn the_hash_is_known() {
        let hash = balls(Collision::Continuous, 60).state_hash();
        assert_eq!(hash, 0xef73_48bf_a00a_0270, "{hash:#018x}");
    }
}
