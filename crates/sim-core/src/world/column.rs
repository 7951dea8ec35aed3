//! A column of a value that is the same for all bodies in most worlds.

use alloc::vec::Vec;

/// Values by body; takes no memory while all are the usual one.
#[derive(Clone, Debug)]
pub(super) struct Column<T> {
    usual: T,
    /// Bodies beyond its end have the usual value.
    values: Vec<T>,
}

impl<T: Copy + PartialEq> Column<T> {
    pub(super) fn new(usual: T) -> Column<T> {
        Column {
            usual,
            values: Vec::new(),
        }
    }

    /// Whether no body was given another value than the usual one.
    #[inline]
    pub(super) fn is_usual(&self) -> bool {
        self.values.is_empty()
    }

    #[inline]
    pub(super) fn get(&self, body: usize) -> T {
        self.values.get(body).copied().unwrap_or(self.usual)
    }

    pub(super) fn set(&mut self, body: usize, value: T) {
        if self.values.get(body).is_none() && value == self.usual {
            return;
        }
        if self.values.len() <= body {
            self.values.resize(body + 1, self.usual);
        }
        self.values[body] = value;
    }

    /// Removes a body; the indices of the bodies after it decrease by one.
    pub(super) fn remove(&mut self, body: usize) {
        if body < self.values.len() {
            self.values.remove(body);
        }
        // The same state as if the body had never existed.
        if self.values.iter().all(|value| *value == self.usual) {
            self.values.clear();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_usual_takes_no_room_and_the_rest_follows_its_body() {
        let mut column = Column::new(1.0);
        column.set(5, 1.0);
        assert!(column.is_usual());
        column.set(2, 3.0);
        assert_eq!(
            [0, 1, 2, 3].map(|body| column.get(body)),
            [1.0, 1.0, 3.0, 1.0]
        );
        column.remove(7);
        column.remove(0);
        assert_eq!([0, 1, 2].map(|body| column.get(body)), [1.0, 3.0, 1.0]);
        column.remove(1);
        assert!(column.is_usual() && column.get(1) == 1.0);
    }
}
