//! Six-axis kinematics from a table: where joints, links and tool of an arm are, and how they move with its axes.
//!
//! Main types: [`ArmKind`], [`ArmPosture`], [`Joints`]. Refuses: tables that contradict themselves, and anything but
//! six turning axes.

use super::capsule::Capsule;
use nalgebra::{Isometry3, Matrix3, Matrix6, Point3, Rotation3, Vector3, Vector6};
use serde::Deserialize;
use std::sync::LazyLock;

/// Angles of the six axes, radians, base first.
pub type Joints = [f64; 6];

/// Points of a pose: the base, the origins of the six frames, and the tip of the tool.
pub const ARM_POINTS: usize = 8;

/// One axis in the notation of Denavit and Hartenberg (1955): a turn by the joint angle and a shift by `d` about z,
/// then a shift by `a` and a turn by `alpha` about x.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct AxisRow {
    /// Shift along the new x axis, metres.
    pub a_m: f64,
    /// Turn about the new x axis, radians.
    pub alpha_rad: f64,
    /// Shift along the old z axis, metres.
    pub d_m: f64,
}

/// One link as a capsule between two points of the pose.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LinkShape {
    /// Number of the point where the link begins: 0 is the base, 1 to 6 the frames, 7 the tool's tip.
    pub from: usize,
    /// Number of the point where the link ends.
    pub to: usize,
    /// Radius, metres.
    pub radius_m: f64,
}

/// What all arms of one kind have in common.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ArmKind {
    /// Name of the kind.
    pub name: String,
    /// The axes, base first.
    pub rows: [AxisRow; 6],
    /// Reach of the tool beyond the last frame, along its z axis, metres.
    pub tool_m: f64,
    /// Least joint angles, radians.
    pub low_rad: Joints,
    /// Greatest joint angles, radians.
    pub high_rad: Joints,
    /// Greatest joint speeds, rad/s.
    pub speed_radps: Joints,
    /// Greatest joint accelerations, rad/s².
    pub acceleration_radps2: Joints,
    /// The links as capsules.
    pub links: Vec<LinkShape>,
}

/// Why a kind of arm is refused.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ArmKindError {
    /// The text is not a table of this kind.
    #[error("the arm's table cannot be read: {0}")]
    Unreadable(String),
    /// The axis with this index has a value that is not finite or negative where that has no meaning, or empty limits.
    #[error("axis {0} of the arm has impossible figures")]
    Axis(usize),
    /// The link with this index has no length, unknown points, or an invalid radius.
    #[error("link {0} of the arm has impossible figures")]
    Link(usize),
}

/// Where every part of an arm is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ArmPosture {
    /// The base, the origins of the six frames, the tip of the tool; map frame, metres.
    pub points: [Point3<f64>; ARM_POINTS],
    /// The direction of each axis; axis `k` turns about a line through `points[k]`.
    pub axes: [Vector3<f64>; 6],
    /// Orientation of the tool.
    pub tool: Rotation3<f64>,
}

static COLLABORATIVE: LazyLock<ArmKind> = LazyLock::new(|| {
    ArmKind::parse(include_str!("collaborative.json")).expect("a test reads the built-in table")
});
static LONG_REACH: LazyLock<ArmKind> = LazyLock::new(|| {
    ArmKind::parse(include_str!("long_reach.json")).expect("a test reads the built-in table")
});

impl ArmKind {
    /// Reads a kind of arm from its table (JSON).
    ///
    /// # Errors
    /// The first fault in the table.
    pub fn parse(text: &str) -> Result<ArmKind, ArmKindError> {
        let kind: ArmKind =
            serde_json::from_str(text).map_err(|e| ArmKindError::Unreadable(e.to_string()))?;
        for (k, row) in kind.rows.iter().enumerate() {
            let finite = [row.a_m, row.alpha_rad, row.d_m, kind.tool_m].iter().all(|x| x.is_finite());
            let limits = kind.low_rad[k] < kind.high_rad[k];
            let moves = kind.speed_radps[k] > 0.0 && kind.acceleration_radps2[k] > 0.0;
            let bounded = kind.speed_radps[k].is_finite() && kind.acceleration_radps2[k].is_finite();
            if !(finite && limits && moves && bounded) {
                return Err(ArmKindError::Axis(k));
            }
        }
        let sound = |link: &LinkShape| {
            link.from < link.to && link.to < ARM_POINTS && (0.001..1.0).contains(&link.radius_m)
        };
        match kind.links.iter().position(|link| !sound(link)) {
            Some(k) => Err(ArmKindError::Link(k)),
            None => Ok(kind),
        }
    }

    /// A collaborative arm for 5 kg with 0.85 m of reach, as several makers sell it.
    pub fn collaborative() -> &'static ArmKind {
        &COLLABORATIVE
    }

    /// A collaborative arm for 10 kg with 1.3 m of reach, as several makers sell it, and a gripper slender enough to
    /// reach into bins.
    pub fn long_reach() -> &'static ArmKind {
        &LONG_REACH
    }

    /// Names of the kinds of arm that maps may use, whose tables are built in.
    pub const NAMES: [&str; 4] = ["ur5", "collaborative", "ur10", "long_reach"];

    /// The kind that a map names; nothing for a name without a built-in table.
    pub fn named(kind: &str) -> Option<&'static ArmKind> {
        match kind {
            "ur5" | "collaborative" => Some(ArmKind::collaborative()),
            "ur10" | "long_reach" => Some(ArmKind::long_reach()),
            _ => None,
        }
    }

    /// Whether all angles are within the arm's limits.
    pub fn allows(&self, joints: &Joints) -> bool {
        let within = |k: usize| joints[k] >= self.low_rad[k] && joints[k] <= self.high_rad[k];
        (0..6).all(within)
    }

    /// The posture of the arm at these angles, with its base at `base`.
    pub fn pose(&self, base: &Isometry3<f64>, joints: &Joints) -> ArmPosture {
        let mut turn: Matrix3<f64> = *base.rotation.to_rotation_matrix().matrix();
        let mut at = Point3::from(base.translation.vector);
        let mut points = [at; ARM_POINTS];
        let mut axes = [Vector3::z(); 6];
        for (k, row) in self.rows.iter().enumerate() {
            axes[k] = turn.column(2).into_owned();
            let (sin, cos) = libm::sincos(joints[k]);
            let (sin_a, cos_a) = libm::sincos(row.alpha_rad);
            let step = Matrix3::new(
                cos,
                -sin * cos_a,
                sin * sin_a, //
                sin,
                cos * cos_a,
                -cos * sin_a, //
                0.0,
                sin_a,
                cos_a,
            );
            at += turn * Vector3::new(row.a_m * cos, row.a_m * sin, row.d_m);
            turn *= step;
            points[k + 1] = at;
        }
        points[7] = at + turn.column(2) * self.tool_m;
        ArmPosture { points, axes, tool: Rotation3::from_matrix_unchecked(turn) }
    }

    /// The links of a posture as capsules, each thickened by `margin_m`.
    pub fn capsules(&self, pose: &ArmPosture, margin_m: f64) -> Vec<Capsule> {
        let capsule = |link: &LinkShape| Capsule {
            a: pose.points[link.from],
            b: pose.points[link.to],
            radius_m: link.radius_m + margin_m,
        };
        self.links.iter().map(capsule).collect()
    }

    /// Angles near `seed` with which the tool's tip is at `tip` and its z axis points along `along`: damped least
    /// squares (Wampler 1986) with a fixed number of steps. Nothing where that does not get within a millimetre.
    pub fn reach(
        &self,
        base: &Isometry3<f64>,
        tip: Point3<f64>,
        along: Vector3<f64>,
        seed: &Joints,
    ) -> Option<Joints> {
        const STEPS: usize = 120;
        const DAMPING: f64 = 1e-3;
        let mut joints = *seed;
        for _ in 0..STEPS {
            let pose = self.pose(base, &joints);
            let error = tip - pose.points[7];
            let axis = pose.tool.matrix().column(2).into_owned();
            let turn = axis.cross(&along);
            if error.norm() < 1e-4 && turn.norm() < 1e-3 && axis.dot(&along) > 0.0 {
                return self.allows(&joints).then_some(joints);
            }
            let limit = 1f64.min(0.2 / error.norm().max(1e-9));
            let wanted = Vector6::from_iterator((error * limit).iter().chain((turn * 0.5).iter()).copied());
            let mut jacobian = Matrix6::zeros();
            for k in 0..6 {
                let column = pose.jacobian_column(7, k);
                jacobian.fixed_view_mut::<3, 1>(0, k).copy_from(&column);
                jacobian.fixed_view_mut::<3, 1>(3, k).copy_from(&pose.axes[k]);
            }
            let square = jacobian * jacobian.transpose() + Matrix6::identity() * DAMPING;
            let step = jacobian.transpose() * square.cholesky()?.solve(&wanted);
            (0..6).for_each(|k| joints[k] += step[k].clamp(-0.3, 0.3));
        }
        None
    }
}

impl ArmPosture {
    /// How the point number `point` moves with axis `k`, metres per radian; zero where the axis comes after the point.
    pub fn jacobian_column(&self, point: usize, k: usize) -> Vector3<f64> {
        self.column_at(self.points[point], point, k)
    }

    /// How a place that moves with the point number `point` moves with axis `k`, metres per radian.
    pub fn column_at(&self, at: Point3<f64>, point: usize, k: usize) -> Vector3<f64> {
        // Axis k first moves frame k + 1.
        if point <= k {
            return Vector3::zeros();
        }
        self.axes[k].cross(&(at - self.points[k]))
    }
}

/// Distance between two configurations, radians: the root of the summed squares.
pub fn joint_distance(a: &Joints, b: &Joints) -> f64 {
    (0..6).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>().sqrt()
}

/// The configuration at a share of the straight path from `a` to `b`.
pub fn between(a: &Joints, b: &Joints, share: f64) -> Joints {
    std::array::from_fn(|k| a[k] + (b[k] - a[k]) * share)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn near(a: Point3<f64>, b: [f64; 3]) -> bool {
        (a - Point3::from(b)).norm() < 1e-6
    }

    #[test]
    fn the_stretched_arm_is_where_the_table_says() {
        let kind = ArmKind::collaborative();
        let pose = kind.pose(&Isometry3::identity(), &[0.0; 6]);
        assert!(near(pose.points[1], [0.0, 0.0, 0.089159]));
        assert!(near(pose.points[2], [-0.425, 0.0, 0.089159]));
        assert!(near(pose.points[3], [-0.81725, 0.0, 0.089159]));
        assert!(near(pose.points[6], [-0.81725, -0.10915 - 0.0823, 0.089159 - 0.09465]), "{:?}", pose.points);
    }

    #[test]
    fn the_jacobian_is_the_derivative_of_the_pose() {
        let kind = ArmKind::collaborative();
        let base = Isometry3::translation(0.3, -0.2, 0.7);
        let joints = [0.4, -1.1, 1.3, -0.7, 0.9, 0.2];
        let pose = kind.pose(&base, &joints);
        for point in 0..ARM_POINTS {
            for k in 0..6 {
                let mut moved = joints;
                moved[k] += 1e-6;
                let change = (kind.pose(&base, &moved).points[point] - pose.points[point]) / 1e-6;
                assert!((change - pose.jacobian_column(point, k)).norm() < 1e-5, "{point} {k}");
            }
        }
    }

    #[test]
    fn the_tool_is_brought_to_a_place_from_above_and_not_beyond_its_reach() {
        let (kind, base) = (ArmKind::collaborative(), Isometry3::identity());
        let seed = [0.0, -1.2, 1.6, -2.0, -1.57, 0.0];
        let tip = Point3::new(-0.45, -0.15, 0.05);
        let joints = kind.reach(&base, tip, -Vector3::z(), &seed).expect("within reach");
        let pose = kind.pose(&base, &joints);
        assert!((pose.points[7] - tip).norm() < 1e-3 && pose.tool.matrix()[(2, 2)] < -0.99);
        assert_eq!(kind.reach(&base, Point3::new(2.0, 0.0, 0.0), -Vector3::z(), &seed), None);
    }

    #[test]
    fn impossible_tables_are_refused() {
        let text = include_str!("collaborative.json");
        let changed = |a: &str, b: &str| ArmKind::parse(&text.replacen(a, b, 1));
        assert!(ArmKind::parse(text).is_ok() && ArmKind::long_reach().links.len() == 5);
        assert_eq!(changed("\"radius_m\": 0.06", "\"radius_m\": -1"), Err(ArmKindError::Link(0)));
        assert_eq!(changed("\"to\": 7", "\"to\": 8"), Err(ArmKindError::Link(4)));
        assert_eq!(changed("[1.0, 1.0, 1.0", "[1.0, 0.0, 1.0"), Err(ArmKindError::Axis(1)));
        assert_eq!(changed("\"low_rad\": [-6.283", "\"low_rad\": [7.0"), Err(ArmKindError::Axis(0)));
        assert!(matches!(changed("tool_m", "tool"), Err(ArmKindError::Unreadable(_))));
    }
}
