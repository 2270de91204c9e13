//! The describing function of a gap.

/// Returns the describing function of a gap over the stiffness beside it, for a wind-up that swings about a flank pressed by
/// `pressed_rad`: first harmonic of the torque over that of the wind-up. 1 while the teeth stay together.
pub fn gap_share(wind_up_rad: f64, pressed_rad: f64, gap_rad: f64) -> f64 {
    if wind_up_rad <= pressed_rad || gap_rad == 0.0 {
        return 1.0;
    }
    // by the midpoint rule over one period: the torque is continuous, and 400 points give four digits
    const POINTS: usize = 400;
    let torque = |swing: f64| {
        let at = pressed_rad + swing;
        if at >= 0.0 { at } else { (at + gap_rad).min(0.0) }
    };
    let sum: f64 = (0..POINTS)
        .map(|k| (std::f64::consts::TAU * (k as f64 + 0.5) / POINTS as f64).cos())
        .map(|cos| torque(wind_up_rad * cos) * cos)
        .sum();
    2.0 * sum / (POINTS as f64 * wind_up_rad)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_gap_has_the_describing_function_of_the_textbook() {
        // D. Atherton: dead zone of half width d, slope 1: N = 1 - (2/pi) (asin r + r sqrt(1 - r^2)), r = d / A; a flank at the edge of
        // the zone is the same as a zone about its middle that is pressed by half its width
        let (gap, swing) = (2e-3, 5e-3);
        let r: f64 = 0.5 * gap / swing;
        let expected = 1.0 - 2.0 / std::f64::consts::PI * (r.asin() + r * (1.0 - r * r).sqrt());
        let middle = gap_share(swing, -0.5 * gap, gap);
        assert!((middle - expected).abs() < 1e-3, "{middle} {expected}");
    }

    #[test]
    fn pressed_teeth_stay_together_until_the_wind_up_exceeds_what_presses_them() {
        assert_eq!(gap_share(1e-4, 2e-4, 1e-3), 1.0);
        assert!(gap_share(4e-4, 2e-4, 1e-3) < 1.0);
    }
}
