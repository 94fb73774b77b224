//! `sky`, `sun` and `sunsky`.

use nephroid::color::Rgb;
use nephroid::light::{EnvironmentMapping, Light, LightKind, SkySettings, sun_sky};
use nephroid::math::real::{atan2, cos_deg, sin_deg};
use nephroid::math::{DVec3, Transform, Vec3};

use super::properties::Plugin;
use super::reader::Reader;

/// Radiance here over that of Mitsuba, for which a spectrum of one has luminance one: the integral of the luminous
/// efficiency in nm.
const UNIT: f32 = 106.857;

impl<'t> Reader<'t> {
    /// Reads a sky, a sun or both into the scene.
    pub(super) fn daylight(&mut self, plugin: &Plugin<'t>) {
        let has_sky = plugin.kind != "sun";
        let has_sun = plugin.kind != "sky";
        if has_sky {
            let message = "the sky is that of Preetham, Shirley and Smits (1999), and not Mitsuba's own";
            self.log.warn(plugin.location(), message);
        }
        let to_world = plugin.transform("to_world");
        // The zenith is +y in the model and before version 2, +z since then.
        let upright = match plugin.element.is_legacy {
            true => Transform::IDENTITY,
            false => Transform::rotate(DVec3::X, 90.0),
        };
        let to_world = upright.then(to_world);
        let local = match plugin.vector("sun_direction") {
            Some(direction) => to_world.inverse().vector(direction),
            None => self.sun_by_clock(plugin),
        };
        let Some(local) = local.try_normalize() else {
            self.log.error(plugin.location(), "the direction to the sun has no length");
            return;
        };
        let scale = plugin.float("scale", 1.0);
        let sky_scale = scale * plugin.float("sky_scale", 1.0);
        let sun_scale = scale * plugin.float("sun_scale", 1.0);
        let aperture = plugin.optional_float("sun_aperture");
        let radius_scale = plugin.float("sun_radius_scale", 1.0);
        let settings = SkySettings {
            turbidity: plugin.float("turbidity", 3.0),
            sun_direction: local,
            scale: 1.0 / UNIT,
            ..SkySettings::default()
        };
        plugin.ignore(&["albedo", "resolution", "stretch", "complex_sun"]);
        let medium = self.surroundings(plugin);
        plugin.finish();
        if local.y <= 0.0 {
            self.log.warn(plugin.location(), "the sun is below the horizon: there is no light");
        }
        let (image, sun) = sun_sky(&settings);
        if let (true, LightKind::Sun { direction, irradiance, angular_radius_deg }) = (has_sun, sun) {
            let irradiance: Rgb = irradiance * sun_scale;
            let angular_radius_deg = aperture.map_or(angular_radius_deg * radius_scale, |angle| 0.5 * angle);
            let direction = to_world.vector(direction).normalize_or_zero();
            let kind = LightKind::Sun { direction, irradiance, angular_radius_deg };
            self.origins.lights.push(plugin.location().clone());
            self.lights.push(Light { name: plugin.name(), kind, medium });
        }
        if has_sky {
            let image = self.textures.images.push(image.into());
            self.origins.images.push(plugin.location().clone());
            let mapping = EnvironmentMapping::Equirectangular;
            self.lights.push(Light {
                name: plugin.name(),
                kind: LightKind::Environment { image, mapping, scale: sky_scale, to_world },
                medium,
            });
            self.origins.lights.push(plugin.location().clone());
        }
    }

    /// Towards the sun at a time and a place, with the zenith at +y: the algorithm of Blanco-Muriel et al. 2001,
    /// doi 10.1016/S0038-092X(00)00156-0, without its parallax of 0.002°.
    fn sun_by_clock(&self, plugin: &Plugin<'t>) -> Vec3 {
        let number = |name, default: f32| f64::from(plugin.float(name, default));
        let (year, month, day) = (number("year", 2010.0), number("month", 7.0), number("day", 10.0));
        let minutes = number("minute", 0.0) + number("second", 0.0) / 60.0;
        let hour = number("hour", 15.0) + minutes / 60.0 - number("timezone", 9.0);
        let latitude = number("latitude", 35.6894);
        let longitude = number("longitude", 139.6917);
        let whole = ((month - 14.0) / 12.0).trunc();
        let days = (1461.0 * (year + 4800.0 + whole) / 4.0).floor()
            + (367.0 * (month - 2.0 - 12.0 * whole) / 12.0).floor()
            - (3.0 * ((year + 4900.0 + whole) / 100.0).floor() / 4.0).floor()
            + day
            - 32_075.0;
        let n = days - 0.5 + hour / 24.0 - 2_451_545.0;
        let degrees = |radians: f64| radians.to_degrees().rem_euclid(360.0);
        let omega = degrees(2.1429 - 0.001_039_459_4 * n);
        let anomaly = degrees(6.240_06 + 0.017_201_969_9 * n);
        let ecliptic = degrees(
            4.895_063
                + 0.017_202_791_698 * n
                + 0.033_416_07 * sin_deg(anomaly)
                + 0.000_348_94 * sin_deg(2.0 * anomaly)
                - 0.000_113_4
                - 0.000_020_3 * sin_deg(omega),
        );
        let obliquity = (0.409_092_8 - 6.214e-9 * n + 0.000_039_6 * cos_deg(omega)).to_degrees();
        let ascension = atan2((cos_deg(obliquity) * sin_deg(ecliptic)) as f32, cos_deg(ecliptic) as f32);
        let sin_declination = sin_deg(obliquity) * sin_deg(ecliptic);
        let cos_declination = (1.0 - sin_declination * sin_declination).max(0.0).sqrt();
        let sidereal = 6.697_424_324_2 + 0.065_709_828_3 * n + hour;
        let angle = (sidereal * 15.0 + longitude - f64::from(ascension).to_degrees()).rem_euclid(360.0);
        let (sin_lat, cos_lat) = (sin_deg(latitude), cos_deg(latitude));
        let up = cos_lat * cos_deg(angle) * cos_declination + sin_declination * sin_lat;
        let east = -sin_deg(angle) * cos_declination;
        let north = sin_declination * cos_lat - sin_lat * cos_deg(angle) * cos_declination;
        // The files' axes, before they are turned upright: older ones have the east at +x and the south at +z, later ones
        // the south at +x and, as no map does, the west at +y.
        match plugin.element.is_legacy {
            true => DVec3::new(east, up, -north).as_vec3(),
            false => DVec3::new(-north, up, east).as_vec3(),
        }
    }
}
