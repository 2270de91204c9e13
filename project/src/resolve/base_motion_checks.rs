//! The needs of the elevated accelerometer and of the motion of the base of the rest of the project.

use counterpoise_models::{AccelerometerAxis, AxisKind, CONVERTER_RANGE_V, Sensor};

use super::findings::Findings;
use super::{Project, platform::PlatformSource};
use crate::diagnostic::{DiagnosticKind, Severity};
use crate::file::source::Remark;
use crate::tolerance::LEAST_SHARE_OF_HEAVE;

/// An accelerometer on the elevated mass turns with a hub that has an elevation.
pub(super) fn check_elevated(findings: &mut Findings<'_>, project: &Project) {
    let sensors = &project.plant.sensors;
    let key = "plant.sensors.platform_accelerometer.axis";
    if sensors.accelerometer_axis == AccelerometerAxis::Vertical {
        return;
    }
    let mut complain = |path: &str, found: String, allowed: &str| {
        findings.add(
            Severity::Error,
            Remark::new(DiagnosticKind::Conflict, path, allowed.to_owned()).with_value(found),
        );
    };
    if project.plant.axis == AxisKind::Linear {
        let allowed = "must be \"vertical\" where plant.axis is \"linear\": a slide has no elevation";
        return complain(key, "\"elevated\"".to_owned(), allowed);
    }
    if sensors.accelerometer_lever_arm_m != 0.0 {
        let allowed = "must be 0 where the accelerometer's axis is \"elevated\": it stands at the pivot";
        let path = "plant.sensors.platform_accelerometer.lever_arm";
        complain(path, sensors.accelerometer_lever_arm_m.to_string(), allowed);
    }
    let angle = project.model.operating_point.hub_angle_rad;
    if angle.cos() < LEAST_SHARE_OF_HEAVE {
        let allowed = "must be within +/- 1.47 rad where the accelerometer's axis is \"elevated\": beyond, it feels next to nothing of heave";
        complain("model.hub_angle", angle.to_string(), allowed);
    }
}

/// A second accelerometer needs the first one, and an angle by which both are projected across the beam.
pub(super) fn check_projection(findings: &mut Findings<'_>, project: &Project) {
    let sensors = &project.plant.sensors;
    let Some(surge) = &sensors.surge_accelerometer else { return };
    let section = "plant.sensors.surge_accelerometer";
    let mut say = |severity: Severity, path: &str, allowed: &str| {
        findings.add(severity, Remark::new(DiagnosticKind::Conflict, path, allowed.to_owned()));
    };
    if project.plant.axis == AxisKind::Linear {
        return say(
            Severity::Error,
            section,
            "must be left out where plant.axis is \"linear\": a slide does not feel surge",
        );
    }
    if !sensors.platform_accelerometer.is_fitted()
        || sensors.accelerometer_axis == AccelerometerAxis::Elevated
    {
        let allowed = "needs [plant.sensors.platform_accelerometer] with axis = \"vertical\": the controller projects heave and surge across the beam";
        return say(Severity::Error, section, allowed);
    }
    if project.model.operating_point.hub_angle_rad.cos() < LEAST_SHARE_OF_HEAVE {
        let allowed = "must be within +/- 1.47 rad where heave and surge are projected across the beam: beyond, it feels next to nothing of heave";
        return say(Severity::Error, "model.hub_angle", allowed);
    }
    if sensors.hub_resolver.is_none() && !sensors.measured.is_position() {
        let allowed = "has no angle by which it is projected: the controller takes the elevation of the design, model.hub_angle, whatever the hub does; add [plant.sensors.hub_resolver]";
        say(Severity::Warning, section, allowed);
    }
    let angle = project.model.operating_point.hub_angle_rad;
    if let Some(resolver) =
        sensors.hub_resolver.as_ref().filter(|one| angle.abs() * one.scale_v_unit > CONVERTER_RANGE_V)
    {
        let most = CONVERTER_RANGE_V / resolver.scale_v_unit;
        let allowed = format!(
            "must be within +/- {most} rad, where the resolver's converter ends: heave and surge are projected by its reading; give [plant.sensors.hub_resolver] a smaller scale"
        );
        return say(Severity::Error, "model.hub_angle", &allowed);
    }
    let heave = &sensors.platform_accelerometer;
    let dynamics = |sensor: &Sensor| {
        let shape = [sensor.natural_frequency_rad_s, sensor.damping_ratio, sensor.gain];
        (shape, [sensor.delay_s, sensor.own_period_s, sensor.alignment.tilt_rad])
    };
    if dynamics(surge) != dynamics(heave) {
        let allowed = "differs from the platform_accelerometer in its dynamics, delay, gain, sample period or tilt: linear figures take both as alike, the simulation takes them as they are";
        say(Severity::Warning, section, allowed);
    }
}

/// A slide does not feel surge, roll and yaw: the axis' equations have heave alone.
pub(super) fn check_slide(findings: &mut Findings<'_>, project: &Project) {
    let road = project.verify.as_ref().and_then(|verify| verify.road.as_ref());
    let Some(PlatformSource::Recording(source)) = road else { return };
    if project.plant.axis == AxisKind::Linear && !source.surge.is_empty() {
        let allowed = "has no effect: a linear axis feels the acceleration along it, which is `heave` here";
        let remark = Remark::new(DiagnosticKind::Conflict, "verify.road.surge", allowed.to_owned());
        findings.add(Severity::Warning, remark.with_value(format!("\"{}\"", source.surge)));
    }
}
