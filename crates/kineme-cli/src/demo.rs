//! `kineme demo`: the choreographed session, from motion to vocabulary to page.

use crate::args::{DemoArgs, Global};
use crate::failure::Failure;

pub fn run(_args: &DemoArgs, _global: &Global) -> Result<u8, Failure> {
    Err(Failure::failed("not there yet"))
}
