//! Where the person looks: following what moves, the way home, and what has left the view.

use std::f64::consts::FRAC_PI_2;

use sim_core::DVec3;

use super::Session;
use crate::camera::Camera;

/// Bodies out of view that are pointed out at a time.
const MOST_OUT: usize = 12;

/// Following, and the opening view.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct View {
    /// Where what is followed was in the last picture, m; none while nothing is.
    followed: Option<DVec3>,
    /// The opening view.
    pub(super) home: Option<Camera>,
}

/// Where to look from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// From `+z`, with `x` to the right.
    Front,
    /// From `+x`.
    Right,
    /// From `+y`, with `x` to the right.
    Top,
}

/// A body whose middle is not in the picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OutOfView {
    /// Its index.
    pub body: usize,
    /// Where it is from the middle of the picture, in halves of its width and height, `y` up.
    pub towards: [f64; 2],
}

impl Session {
    /// Whether the camera goes along with what moves.
    pub fn is_following(&self) -> bool {
        self.view.followed.is_some()
    }

    /// Lets the camera go along with the selected body, or with the middle of all that moves.
    pub fn follow(&mut self, on: bool) {
        self.view.followed = self.leader().filter(|_| on);
    }

    /// Looks as when the scene was opened, and follows nothing.
    pub fn go_home(&mut self) {
        self.view.followed = None;
        if let Some(home) = self.view.home {
            self.camera = home;
        }
    }

    /// Looks from one of the sides, and keeps what is in the middle.
    pub fn look_from(&mut self, side: Side) {
        (self.camera.yaw, self.camera.pitch) = match side {
            Side::Front => (0.0, 0.0),
            Side::Right => (FRAC_PI_2, 0.0),
            Side::Top => (0.0, FRAC_PI_2),
        };
    }

    /// Moves the camera with what it follows.
    pub(super) fn keep_up(&mut self) {
        let (Some(before), Some(now)) = (self.view.followed, self.leader()) else {
            return;
        };
        self.camera.target += now - before;
        self.view.followed = Some(now);
    }

    /// Looks elsewhere at what is followed, as after another body is selected.
    pub(super) fn follow_anew(&mut self) {
        if self.is_following() {
            self.follow(true);
        }
    }

    /// Where what is followed is drawn, m.
    fn leader(&self) -> Option<DVec3> {
        if let Some(selected) = self.selection.filter(|&i| i < self.world.len()) {
            return Some(self.shown_centre(selected));
        }
        let moving = (0..self.world.len()).filter(|&i| !self.is_static(i));
        let (sum, count) = moving.fold((DVec3::ZERO, 0.0), |(sum, count), i| {
            (sum + self.shown_centre(i), count + 1.0)
        });
        (count > 0.0).then(|| sum / count)
    }

    /// Bodies that could be seen and are not, in a picture so much wider than high: those that move, or
    /// the selected one.
    pub fn out_of_view(&self, aspect: f64) -> Vec<OutOfView> {
        let bodies = (0..self.world.len())
            .filter(|&i| !self.is_half_space(i))
            .filter(|&i| !self.is_static(i) || self.selection == Some(i));
        let out = bodies.filter_map(|body| {
            let at = self.shown_position(body) + self.bounds(body).centre;
            let towards = match self.camera.project(at, aspect) {
                Some([x, y]) if x.abs() <= 1.0 && y.abs() <= 1.0 => return None,
                Some(towards) => towards,
                // Behind the eye: the way to turn.
                None => {
                    let [right, up, _] = self.camera.axes();
                    let away = at - self.camera.eye();
                    [away.dot(right), away.dot(up)]
                }
            };
            let seen = towards.iter().all(|part| part.is_finite()) && towards != [0.0, 0.0];
            seen.then_some(OutOfView { body, towards })
        });
        out.take(MOST_OUT).collect()
    }
}
