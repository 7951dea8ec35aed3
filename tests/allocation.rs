//! Only the first step allocates, and no query about meshes does.

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

use std::ops::ControlFlow;

use scene::SCENES;
use sim_core::collide::{self, Placement, tree};
use sim_core::query::{self, Placed};
use sim_core::{Body, Bvh, Collision, DQuat, DVec3, Force, METHODS, Settings, World};

thread_local! {
    static ALLOCATIONS: Cell<u64> = const { Cell::new(0) };
}

/// The system's allocator with a counter for each thread.
struct Counting;

#[allow(unsafe_code)]
// SAFETY: every call goes to the system's allocator unchanged.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        ALLOCATIONS.with(|count| count.set(count.get() + 1));
        // SAFETY: the caller upholds the contract.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, memory: *mut u8, layout: Layout) {
        // SAFETY: the caller upholds the contract.
        unsafe { System.dealloc(memory, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

fn allocations(act: impl FnOnce()) -> u64 {
    let before = ALLOCATIONS.with(Cell::get);
    act();
    ALLOCATIONS.with(Cell::get) - before
}

#[test]
fn what_is_allocated_is_counted() {
    assert_eq!(allocations(|| drop(std::hint::black_box(vec![0; 9]))), 1);
}

#[test]
fn steps_after_the_first_do_not_allocate() {
    let drag = Force::QuadraticDrag {
        body: None,
        coefficient: 0.1,
    };
    let weak = Force::LinearDrag {
        body: Some(4),
        coefficient: 0.2,
    };
    let spring = Force::Spring {
        bodies: [3, 9],
        points: None,
        rest_length: 1.0,
        stiffness: 20.0,
        damping: 0.5,
    };
    let gravitation = Force::Gravitation { constant: 1e-3 };
    let forces: [&[Force]; 4] = [&[], &[weak], &[drag.clone(), spring], &[drag, gravitation]];
    for forces in forces {
        for method in METHODS {
            let settings = Settings {
                method,
                ..Settings::default()
            };
            let mut world = World::new(settings).expect("settings");
            for i in 0..20 {
                world
                    .add(Body {
                        position: f64::from(i) * DVec3::X,
                        velocity: DVec3::new(0.0, 1.0, 0.1 * f64::from(i)),
                        force: -DVec3::Y,
                        ..Body::default()
                    })
                    .expect("a body");
            }
            for force in forces {
                world.add_force(force.clone()).expect("a force");
            }
            world.step().expect("a step");
            let later = allocations(|| (0..20).for_each(|_| world.step().expect("a step")));
            assert_eq!(later, 0, "{} {forces:?}", method.name);
        }
    }
}

#[test]
fn questions_about_meshes_do_not_allocate() {
    let cow = scene::mesh_file::builtin("cow.obj").expect("built in");
    let cow = Bvh::build(&cow);
    let turn = DQuat::from_rotation_y(0.7);
    let questions = || {
        let mut answers = 0;
        for i in 0..40 {
            let offset = DVec3::new(0.03 * f64::from(i), 0.5, 0.2);
            let turned = Placement::turned(turn, offset).expect("a rotation");
            for at in [Placement::from(offset), turned] {
                answers += usize::from(tree::intersect(&cow, &cow, at));
                answers += usize::from(collide::contains(&cow, &cow, at));
                let _ = tree::each_hit(&cow, &cow, at, |_| {
                    answers += 1;
                    ControlFlow::Continue(())
                });
            }
            answers += usize::from(cow.ray(offset, -offset).is_some());
            answers += usize::from(collide::segment_meets(&cow, offset, -offset) == Some(true));
            answers += usize::from(collide::locate(&cow, offset).is_some());
            let [first, second] =
                [DVec3::ZERO, offset].map(|at| Placed::mesh(&cow, at).expect("a place"));
            answers += usize::from(query::distance(first, second).is_some());
            answers += usize::from(query::time_of_impact(first, second, offset) == Ok(None));
        }
        assert!(answers > 1000, "{answers}");
    };
    assert_eq!(allocations(questions), 0);
}

/// The number of steps after which a scene has allocated all its buffers, except for events that it has not had yet.
const WARM_UP: u32 = 60;

/// Scenes with persisting contacts: each island is solved in vectors of its own.
const SOLVED: [&str; 2] = ["bounce", "herd"];

/// Steps without an impact may enlarge growing buffers, a few times in a run.
const GROWTH: u64 = 24;

/// With solids, in the continuous mode and the BVH mode. Allocations are made for the response to an impact (the bodies
/// in it, and its report), and for the contacts of a persisting island.
#[test]
fn steps_of_the_gallery_allocate_only_where_bodies_meet() {
    for entry in SCENES {
        for collision in [Collision::Continuous, Collision::Bvh] {
            let mut scene = entry.scene().expect("a gallery scene");
            scene.collision = collision;
            // Searches among turning bodies allocate their queues each time, and the discrete modes rotate no bodies.
            if scene.bodies.iter().any(|body| body.turn.is_some()) {
                continue;
            }
            let mut world = scene.world().expect("a world");
            (0..WARM_UP).for_each(|_| world.step().expect("a step"));
            let mut without = 0;
            for _ in 0..400 {
                let before = (world.impacts(), world.contact_steps());
                let made = allocations(|| world.step().expect("a step"));
                if (world.impacts(), world.contact_steps()) == before {
                    without += made;
                }
            }
            let is_solved = SOLVED.contains(&entry.name) && collision == Collision::Continuous;
            let what = format!("{} {collision:?}", entry.name);
            assert!(is_solved || without <= GROWTH, "{what}: {without}");
        }
    }
}

/// Steps that list contacts allocate no more than others, once the lists have their capacity.
#[test]
fn events_of_contacts_do_not_allocate() {
    for entry in SCENES {
        let scene = entry.scene().expect("a gallery scene");
        let [mut plain, mut listing] = [(), ()].map(|()| scene.world().expect("a world"));
        listing.list_contact_events(true);
        let (mut more, mut events) = (0, 0);
        for k in 0..WARM_UP + 200 {
            let own = allocations(|| plain.step().expect("a step"));
            let all = allocations(|| listing.step().expect("a step"));
            assert!(all >= own, "{} {k}", entry.name);
            more += if k < WARM_UP { 0 } else { all - own };
            events += listing.contact_events().len();
        }
        // Lists of impacts, contacts and events grow when there are more of them than before.
        assert!(more <= GROWTH, "{}: {more} for {events} events", entry.name);
    }
}
