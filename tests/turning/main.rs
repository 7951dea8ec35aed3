//! Bodies that turn, against closed forms.

mod discrete;
mod flight;
mod impacts;
mod overlaps;
mod rest;
mod times;
