//! What measured eyes say about where a hand goes: people look at a slot before they reach into it, and keep looking
//! until the piece is out.
//!
//! Main types: [`Fixation`] (follows a ray of eyes from fixation to fixation), [`LookedAt`]. Refuses: rays of heads and
//! estimated rays; a head turns only part of the way, and an estimate would repeat what the hand has said.

use super::face::FacePlace;

/// Angle from the last fixation beyond which a ray is a jump, radians.
const JUMP_RAD: f64 = 0.1;
/// Age from which a fixation counts, and time over which its rays are averaged, seconds.
const SETTLES_S: f64 = 0.05;
const AVERAGES_S: f64 = 0.1;
/// Time without rays after which a fixation has ended, seconds.
const STALE_S: f64 = 0.25;
/// Standard deviation between the eyes' ray and the middle of the place that a hand goes to, radians: the sensor's
/// error, and where in a slot a piece lies.
const SIGMA_RAD: f64 = 0.05;
/// Share of the time for which eyes are elsewhere, and the area over which they then look at anything, square radians.
const ELSEWHERE: f64 = 0.25;
const FIELD_RAD2: f64 = 1.0;

/// Where the eyes rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Fixation {
    ray: FacePlace,
    since_s: f64,
    seen_s: f64,
}

/// A fixation seen from the head's position.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct LookedAt {
    head: FacePlace,
    ray: FacePlace,
}

impl Fixation {
    /// The fixation after one more ray of length one. Rays that are not newer change nothing.
    pub fn then(before: Option<Fixation>, ray: FacePlace, now_s: f64) -> Fixation {
        let Some(before) = before.filter(|b| now_s - b.seen_s < STALE_S) else {
            return Fixation { ray, since_s: now_s, seen_s: now_s };
        };
        let dt_s = now_s - before.seen_s;
        if dt_s <= 0.0 {
            return before;
        }
        if before.ray.angle(&ray) > JUMP_RAD {
            return Fixation { ray, since_s: now_s, seen_s: now_s };
        }
        let mean = before.ray + (ray - before.ray) * (dt_s / AVERAGES_S).min(1.0);
        Fixation { ray: mean.try_normalize(1e-6).unwrap_or(ray), since_s: before.since_s, seen_s: now_s }
    }

    /// What is looked at from this head; nothing while the eyes have just jumped, or were not seen recently.
    pub fn from(&self, head: FacePlace, now_s: f64) -> Option<LookedAt> {
        let settled = self.seen_s - self.since_s >= SETTLES_S && now_s - self.seen_s < STALE_S;
        settled.then_some(LookedAt { head, ray: self.ray })
    }
}

impl LookedAt {
    /// How much likelier this ray is for a person who reaches for this place than for one who looks at anything.
    pub fn ratio(&self, place: FacePlace) -> f64 {
        let off_rad = self.ray.angle(&(place - self.head));
        let density = libm::exp(-off_rad * off_rad / (2.0 * SIGMA_RAD * SIGMA_RAD))
            / (2.0 * std::f64::consts::PI * SIGMA_RAD * SIGMA_RAD);
        ELSEWHERE + (1.0 - ELSEWHERE) * FIELD_RAD2 * density
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const HEAD: FacePlace = FacePlace::new(0.0, 1.05, 1.63);
    const SLOT: FacePlace = FacePlace::new(0.33, 0.44, 1.2);
    const BESIDE: FacePlace = FacePlace::new(0.11, 0.44, 1.2);

    /// The fixation after rays at 60 Hz, and the time of the last one, `now_s`.
    fn after(rays: impl Iterator<Item = FacePlace>) -> (Option<Fixation>, f64) {
        let (mut fixation, mut now_s) = (None, 0.0);
        for ray in rays {
            now_s += 1.0 / 60.0;
            fixation = Some(Fixation::then(fixation, (ray - HEAD).normalize(), now_s));
        }
        (fixation, now_s)
    }

    #[test]
    fn eyes_that_rest_on_a_slot_speak_for_it_and_against_the_one_beside() {
        let (fixation, now_s) = after(std::iter::repeat_n(SLOT, 6));
        let looked = fixation.unwrap().from(HEAD, now_s).expect("they have settled");
        assert!(looked.ratio(SLOT) > 20.0, "{}", looked.ratio(SLOT));
        assert!(looked.ratio(BESIDE) < 1.0, "{}", looked.ratio(BESIDE));
        assert!(looked.ratio(BESIDE) >= ELSEWHERE, "eyes wander");
    }

    #[test]
    fn eyes_that_have_just_jumped_or_are_not_seen_any_more_say_nothing() {
        let jumps = std::iter::repeat_n(SLOT, 6).chain(std::iter::repeat_n(BESIDE, 3));
        let (fixation, now_s) = after(jumps.clone());
        assert_eq!(fixation.unwrap().from(HEAD, now_s), None, "33 ms after the jump");
        let (fixation, now_s) = after(jumps.chain(std::iter::repeat_n(BESIDE, 3)));
        let looked = fixation.unwrap().from(HEAD, now_s).expect("83 ms after the jump");
        assert!(looked.ratio(BESIDE) > 20.0 && looked.ratio(SLOT) < 1.0);
        assert_eq!(fixation.unwrap().from(HEAD, now_s + 0.3), None);
    }

    #[test]
    fn rays_of_one_fixation_are_averaged_and_late_ones_change_nothing() {
        let shaken = (0..60).map(|i| SLOT + FacePlace::new(if i % 2 == 0 { 0.02 } else { -0.02 }, 0.0, 0.0));
        let (fixation, now_s) = after(shaken);
        let fixation = fixation.unwrap();
        assert!(fixation.ray.angle(&(SLOT - HEAD)) < 0.01, "{}", fixation.ray.angle(&(SLOT - HEAD)));
        assert_eq!(Fixation::then(Some(fixation), (BESIDE - HEAD).normalize(), now_s), fixation);
    }
}
