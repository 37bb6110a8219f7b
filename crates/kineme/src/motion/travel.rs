//! How far a motion has led: the root's travel since its beginning.

use super::body_motion::Motion;

impl Motion {
    /// Of each frame, what the root has travelled since the first: forward and to the left, metres, as the body faced on
    /// its way, and the turn to the left, radians.
    pub fn travelled(&self) -> Vec<[f64; 3]> {
        let mut since = vec![[0.0; 3]];
        for (k, pair) in self.roots().windows(2).enumerate() {
            let step = pair[1].position - pair[0].position;
            let (sin, cos) = (0.5 * (pair[0].yaw + pair[1].yaw)).sin_cos();
            let [forward, left, turn] = since[k];
            since.push([
                forward + cos * step.x + sin * step.y,
                left + cos * step.y - sin * step.x,
                turn + pair[1].yaw - pair[0].yaw,
            ]);
        }
        since
    }
}
