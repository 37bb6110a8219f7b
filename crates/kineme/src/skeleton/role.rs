//! Roles: which part of a human body a joint moves.

use crate::error::{Error, Result};

macro_rules! roles {
    ($($variant:ident $name:literal),* $(,)?) => {
        /// The part of a humanoid body that a joint moves: the VRM/Unity humanoid set, with `fingers` for the hand's direction.
        ///
        /// A joint of role `left_upper_arm` sits in the left shoulder and turns the left upper arm.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
        pub enum Role {
            $(#[doc = concat!("`", $name, "`")] $variant,)*
        }

        impl Role {
            /// All roles, trunk first, then left and right limbs from the root to the tip.
            pub const ALL: &'static [Role] = &[$(Role::$variant),*];

            /// The role's name as people write it: `left_upper_arm`.
            pub fn name(self) -> &'static str {
                match self { $(Role::$variant => $name),* }
            }
        }
    };
}

roles! {
    Hips "hips", Spine "spine", Chest "chest", UpperChest "upper_chest", Neck "neck", Head "head",
    LeftShoulder "left_shoulder", LeftUpperArm "left_upper_arm", LeftLowerArm "left_lower_arm",
    LeftHand "left_hand", LeftFingers "left_fingers",
    RightShoulder "right_shoulder", RightUpperArm "right_upper_arm", RightLowerArm "right_lower_arm",
    RightHand "right_hand", RightFingers "right_fingers",
    LeftUpperLeg "left_upper_leg", LeftLowerLeg "left_lower_leg", LeftFoot "left_foot", LeftToes "left_toes",
    RightUpperLeg "right_upper_leg", RightLowerLeg "right_lower_leg", RightFoot "right_foot", RightToes "right_toes",
}

impl Role {
    /// The role on the other side of the body; the trunk's roles are their own.
    pub fn mirrored(self) -> Self {
        use Role::*;
        match self {
            Hips | Spine | Chest | UpperChest | Neck | Head => self,
            LeftShoulder => RightShoulder,
            LeftUpperArm => RightUpperArm,
            LeftLowerArm => RightLowerArm,
            LeftHand => RightHand,
            LeftFingers => RightFingers,
            RightShoulder => LeftShoulder,
            RightUpperArm => LeftUpperArm,
            RightLowerArm => LeftLowerArm,
            RightHand => LeftHand,
            RightFingers => LeftFingers,
            LeftUpperLeg => RightUpperLeg,
            LeftLowerLeg => RightLowerLeg,
            LeftFoot => RightFoot,
            LeftToes => RightToes,
            RightUpperLeg => LeftUpperLeg,
            RightLowerLeg => LeftLowerLeg,
            RightFoot => LeftFoot,
            RightToes => LeftToes,
        }
    }

    /// The role with this name.
    ///
    /// # Errors
    /// For a name that is no role; the message lists them.
    pub fn parse(name: &str) -> Result<Self> {
        Self::ALL
            .iter()
            .copied()
            .find(|r| r.name() == name)
            .ok_or_else(|| Error::unknown_name("role", name, Self::ALL.iter().map(|r| r.name())))
    }
}
