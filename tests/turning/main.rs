//! Bodies that turn, against closed forms.

mod flight;
mod times;
