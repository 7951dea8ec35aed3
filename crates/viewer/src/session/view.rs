//! The viewpoint of the user: following bodies, the home view, and bodies out of view.

use std::f64::consts::FRAC_PI_2;

use sim_core::DVec3;

use super::Session;
use crate::camera::Camera;

/// The most bodies out of view that are indicated at a time.
const MOST_OUT: usize = 12;

/// The state of following, and the opening view.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct View {
    /// The position of the followed object in the last picture, m; `None` while nothing is followed.
    followed: Option<DVec3>,
    /// The opening view.
    pub(super) home: Option<Camera>,
}

/// A standard viewpoint.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// From `+z`, with `x` to the right.
    Front,
    /// From `+x`.
    Right,
    /// From `+y`, with `x` to the right.
    Top,
}

/// A body whose middle is outside the picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OutOfView {
    /// Its index.
    pub body: usize,
    /// Its direction from the middle of the picture, in halves of its width and height, `y` up.
    pub towards: [f64; 2],
}

impl Session {
    /// Whether the camera follows a moving object.
    pub fn is_following(&self) -> bool {
        self.view.followed.is_some()
    }

    /// Makes the camera follow the selected body, or the middle of all moving bodies.
    pub fn follow(&mut self, on: bool) {
        self.view.followed = self.leader().filter(|_| on);
    }

    /// Restores the view of the scene as opened, and stops following.
    pub fn go_home(&mut self) {
        self.view.followed = None;
        if let Some(home) = self.view.home {
            self.camera = home;
        }
    }

    /// Looks from one of the sides, and keeps the middle of the view.
    pub fn look_from(&mut self, side: Side) {
        (self.camera.yaw, self.camera.pitch) = match side {
            Side::Front => (0.0, 0.0),
            Side::Right => (FRAC_PI_2, 0.0),
            Side::Top => (0.0, FRAC_PI_2),
        };
    }

    /// Moves the camera with the followed object.
    pub(super) fn keep_up(&mut self) {
        let (Some(before), Some(now)) = (self.view.followed, self.leader()) else {
            return;
        };
        self.camera.target += now - before;
        self.view.followed = Some(now);
    }

    /// Restarts following, for example after another body is selected.
    pub(super) fn follow_anew(&mut self) {
        if self.is_following() {
            self.follow(true);
        }
    }

    /// The drawn position of the followed object, m.
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

    /// Bodies outside a picture of an aspect ratio (width over height) that could be seen: the moving ones, or the
    /// selected one.
    pub fn out_of_view(&self, aspect: f64) -> Vec<OutOfView> {
        let bodies = (0..self.world.len())
            .filter(|&i| !self.is_half_space(i))
            .filter(|&i| !self.is_static(i) || self.selection == Some(i));
        let out = bodies.filter_map(|body| {
            let at = self.shown_position(body) + self.bounds(body).centre;
            let towards = match self.camera.project(at, aspect) {
                Some([x, y]) if x.abs() <= 1.0 && y.abs() <= 1.0 => return None,
                Some(towards) => towards,
                // Behind the eye: the direction in which to turn.
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
