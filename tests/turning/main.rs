//! Turning bodies, against closed forms.

mod discrete;
mod flight;
mod impacts;
mod levers;
mod overlaps;
mod rest;
mod times;
