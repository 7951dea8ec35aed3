//! Bodies that turn, against closed forms.

mod discrete;
mod flight;
mod impacts;
mod rest;
mod times;
