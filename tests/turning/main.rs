//! Bodies that turn, against closed forms.

mod flight;
mod impacts;
mod rest;
mod times;
