//! Tells the linker where tests and examples of this crate find the physics engine when they run.

fn main() {
    println!("cargo::rerun-if-env-changed=MUJOCO_DYNAMIC_LINK_DIR");
    if let Ok(folder) = std::env::var("MUJOCO_DYNAMIC_LINK_DIR")
        && std::env::var("CARGO_CFG_TARGET_OS").is_ok_and(|os| os != "windows")
    {
        println!("cargo::rustc-link-arg=-Wl,-rpath,{folder}");
    }
}
