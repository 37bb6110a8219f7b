//! Tells the linker where what is built with physics finds the engine when it runs.

fn main() {
    println!("cargo::rerun-if-env-changed=MUJOCO_DYNAMIC_LINK_DIR");
    let with_physics = std::env::var_os("CARGO_FEATURE_SIM").is_some();
    if let Ok(folder) = std::env::var("MUJOCO_DYNAMIC_LINK_DIR")
        && with_physics
        && std::env::var("CARGO_CFG_TARGET_OS").is_ok_and(|os| os != "windows")
    {
        println!("cargo::rustc-link-arg=-Wl,-rpath,{folder}");
    }
}
