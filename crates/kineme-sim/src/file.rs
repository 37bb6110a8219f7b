//! [`RobotFile`]: a robot that a file describes, and how it is made ready to be driven.

use std::path::PathBuf;
use std::sync::Arc;

use kineme::{Error, Result, Skeleton};
use kineme_formats::robot::RobotModel;
use mujoco_rs::mujoco_c::{mjtDisableBit, mjtIntegrator, mjtTrn};
use mujoco_rs::prelude::{MjModel, MjSpec, SpecElement, SpecObject};
use mujoco_rs::wrappers::mj_editing::MjtLimited;
use mujoco_rs::wrappers::mj_model::{MjtBias, MjtJoint, MjtObjBase};

use crate::plant::engine;
use crate::settings::SimSettings;

/// A robot that an MJCF or URDF file describes.
#[derive(Debug, Clone, PartialEq)]
pub struct RobotFile {
    /// The file; meshes lie where it says.
    pub path: PathBuf,
    /// The robot as MJCF, read in place of the file where there is one, as for a URDF.
    pub mjcf: Option<String>,
    /// The robot's body in our terms: hinges alone, every frame the world's where all coordinates are zero.
    pub skeleton: Arc<Skeleton>,
    /// For each coordinate of the body the file's joint that it turns.
    pub hinges: Vec<String>,
    /// For each coordinate the angle (radians) of that joint where the coordinate is zero.
    pub offsets: Vec<f64>,
    /// The body of the file that is welded to the world; its free joint, if it has one, is taken off.
    pub base: String,
}

impl From<RobotModel> for RobotFile {
    fn from(model: RobotModel) -> Self {
        Self {
            hinges: model.hinges.iter().map(|h| h.joint.clone()).collect(),
            offsets: model.hinges.iter().map(|h| h.neutral_rad).collect(),
            base: model.root,
            path: model.path,
            mjcf: model.mjcf,
            skeleton: Arc::new(model.skeleton),
        }
    }
}

/// The model of a robot, welded at its base, with one drive a joint in the order of the joints.
///
/// # Errors
/// When the file cannot be read or compiled, or has no such base.
pub(crate) fn load(robot: &RobotFile, settings: &SimSettings) -> Result<MjModel> {
    let dof = robot.skeleton.dof();
    let mut kinds = robot.skeleton.joints().iter();
    if let Some(ball) = kinds.find(|j| j.kind.dof() > 1) {
        return Err(Error::invalid(format!(
            "a robot of a file is made of hinges, but `{}` is a ball",
            ball.name
        )));
    }
    if robot.hinges.len() != dof || robot.offsets.len() != dof {
        return Err(Error::invalid(format!(
            "a robot of {dof} coordinates has as many hinges and offsets, found {} and {}",
            robot.hinges.len(),
            robot.offsets.len()
        )));
    }
    let mut spec = match &robot.mjcf {
        // The engine's strings end at a zero byte.
        Some(text) if text.contains('\0') => {
            return Err(Error::invalid(
                "the MJCF of a robot is text without zero bytes",
            ));
        }
        Some(text) => MjSpec::from_xml_string(text).map_err(engine)?,
        None => MjSpec::from_xml(&robot.path).map_err(engine)?,
    };
    if spec.body(&robot.base).is_none() {
        let known: Vec<&str> = spec.body_iter().map(|b| b.name()).collect();
        return Err(Error::unknown_name("body of the robot", &robot.base, known));
    }
    let strengths = strengths(&spec);
    strip(&mut spec, &robot.base)?;
    let option = spec.option_mut();
    option.timestep = settings.step_secs;
    option.integrator = mjtIntegrator::mjINT_IMPLICITFAST as i32;
    for (off, bit) in [
        (!settings.contacts, mjtDisableBit::mjDSBL_CONTACT),
        (!settings.joint_limits, mjtDisableBit::mjDSBL_LIMIT),
    ] {
        if off {
            option.disableflags |= bit as i32;
        }
    }
    for joint in spec.joint_iter_mut() {
        let armature = joint.armature().max(settings.armature);
        joint.set_armature(armature);
        // The drives' own limits stand for those of the joints, so that what is at its limit can be counted.
        joint.set_actfrclimited(MjtLimited::mjLIMITED_FALSE);
    }
    // In the order of the compiled joints, which need not be that of the file's elements.
    let model = spec.compile().map_err(engine)?;
    let names: Vec<String> = (0..model.jnt_type().len())
        .map(|j| {
            let name = model.id_to_name(MjtObjBase::mjOBJ_JOINT, j);
            name.map(String::from)
                .ok_or_else(|| Error::unsupported(format!("joint {j} of the robot has no name")))
        })
        .collect::<Result<_>>()?;
    for name in &names {
        let drive = spec.add_actuator();
        drive.set_target(name);
        drive.set_trntype(mjtTrn::mjTRN_JOINT);
        drive.set_biastype(MjtBias::mjBIAS_AFFINE);
        let strength = strengths.iter().find(|(joint, _)| joint == name);
        if let (true, Some((_, most))) = (settings.torque_limits, strength) {
            drive.set_forcelimited(MjtLimited::mjLIMITED_TRUE);
            *drive.forcerange_mut() = [-most, *most];
        }
    }
    spec.compile().map_err(engine)
}

/// The torque (N m) that the file allows each joint at most: what it says of the joint, else of the force of its drive,
/// else of a plain motor's control.
fn strengths(spec: &MjSpec) -> Vec<(String, f64)> {
    // A range that is not given is empty.
    let most = |range: &[f64; 2]| (range[0] < range[1]).then(|| range[0].abs().min(range[1].abs()));
    let mut strengths = Vec::new();
    for joint in spec.joint_iter() {
        let limited = joint.actfrclimited() != MjtLimited::mjLIMITED_FALSE;
        if let Some(most) = most(joint.actfrcrange()).filter(|_| limited) {
            strengths.push((joint.name().to_string(), most));
        }
    }
    for drive in spec.actuator_iter() {
        let motor = drive.biastype() == MjtBias::mjBIAS_NONE;
        let control = most(drive.ctrlrange()).filter(|_| motor);
        let force = most(drive.forcerange());
        let force = force.or(control.map(|most| most * drive.gainprm()[0].abs()));
        if let Some(force) = force {
            // The first that a joint has counts.
            strengths.push((drive.target().to_string(), force * drive.gear()[0].abs()));
        }
    }
    strengths
}

/// Takes off the free joint of the base and whatever refers to joints and drives that are no more.
fn strip(spec: &mut MjSpec, base: &str) -> Result<()> {
    // Each round takes a fresh handle and keeps none.
    while let Some(key) = spec.key_iter_mut().next() {
        delete(key)?;
    }
    while let Some(sensor) = spec.sensor_iter_mut().next() {
        delete(sensor)?;
    }
    while let Some(drive) = spec.actuator_iter_mut().next() {
        delete(drive)?;
    }
    if let Some(base) = spec.body_mut(base)
        && let Some(joint) = base
            .joint_iter_mut(false)
            .find(|j| j.type_() == MjtJoint::mjJNT_FREE)
    {
        delete(joint)?;
    }
    Ok(())
}

/// Takes an element off its specification; its handle is not to be used again.
#[allow(unsafe_code)]
fn delete(element: &mut impl SpecObject) -> Result<()> {
    // SAFETY: `strip`, the only caller, gives each live element once, and holds no other handle.
    unsafe { element.delete() }.map_err(engine)
}
