//! Section IV: humanoids that move in physics, what disturbs them, and the sparring loop; the tables of
//! `docs/control.md` and `docs/benchmarks.md`.

pub mod disturbance;
pub mod robots;
pub mod speed;
pub mod tables;
pub mod tracking;
