//! Whole-program tests of Eyerays.
