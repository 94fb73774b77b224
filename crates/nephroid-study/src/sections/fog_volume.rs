//! Fog by photons in it.

use nephroid::integrator::{DirectSource, MapName, Method, PhotonMapperConfig};
use nephroid::laboratory::record_photons;
use nephroid::math::{Ray, warp};
use nephroid::session::RenderSettings;
use nephroid::world::World;

use crate::body::{Body, Number};
use crate::format;
use crate::lab::Lab;
use crate::picture::{Look, Picture};
use crate::section::{Section, Stop, Weight};
use crate::tracer;
use crate::wrong;

/// Figure 3.7.
pub const SECTION: Section = Section {
    id: "fig-3-7",
    report: "Fig 3.7",
    title: "fog by a photon map of its own",
    weight: Weight { full: 150.0, quick: 4.0 },
    run,
};

/// Of the fog at the scene's scale, in 1/m, and σ_s / σ_t.
const SIGMA_T: f64 = 0.8;
const ALBEDO: f64 = 0.5 / 8.0;

fn run(lab: &Lab) -> Result<Body, Stop> {
    // The report's numbers, or few.
    let recipe = lab.recipe("report-3-7");
    let recipe = if lab.is_quick() {
        recipe.set("photons", 20_000).set("caustic_photons", 20_000).set("volume_photons", 30_000)
    } else {
        recipe
    };
    let of = |k: u32, report: bool| {
        let recipe = recipe.clone().set("volume_neighbours", k).set("spp", lab.pick(4, 8));
        lab.render(&if report {
            recipe.set("volume_estimate", "march-report").set("single_scatter", "map")
        } else {
            recipe
        })
    };
    let (few, many) = (of(50, false)?, of(300, false)?);
    let (report_few, report_many) = (of(50, true)?, of(300, true)?);

    let mut body = Body::new();
    body.say(
        "Photons in the fog itself: the lamp glows, and the caustic of the glass sphere is a cone of light in the air, which ambient fog \
         cannot show. With more neighbours it is smoother and wider, as in the report. The report does not say how large its \
         box is; at σ_t = 8 per metre nothing would be seen through ours, so the fog is ten times thinner.",
    );
    body.say(
        "On the left is the report's form: steps of one length, and all light from the map. On the right each photon near the ray counts \
         (the beam estimate), and light that is scattered once comes by rays to the lamp. The report's 1/σ_s is right only if \
         photons are stored after the roulette by the albedo; here a photon carries what is scattered, and nothing is divided.",
    );
    let look = Look::exposed(0.5);
    let alt = "A glass sphere in a box full of fog; the lamp above it glows";
    let fog = format!(
        "σ_t = {}/m, σ_s = {}/m, a tenth of the report's 8 and 0.5 for the scale of our box",
        format::number(SIGMA_T),
        format::number(ALBEDO * SIGMA_T)
    );
    let (report, ours) = (", the report's march", ", the beam estimate");
    for (k, wrong, right) in [(50, &report_few, &few), (300, &report_many, &many)] {
        body.pair(
            Picture::of(
                wrong,
                &look,
                &format!("{alt}{report}, k = {k}."),
                &format!("k = {k}{report}; {fog}"),
            )?,
            Picture::of(right, &look, &format!("{alt}{ours}, k = {k}."), &format!("k = {k}{ours}; {fog}"))?,
        );
    }
    body.say(
        "Two more things in the report's text are not right. It draws a distance from the exponential law and then asks again, with the \
         probability of an interaction within that distance: that counts it twice, and loses half of all interactions or more. \
         And a step takes all that is scattered in it as if nothing of it were lost on the way to its end.",
    );
    let step_rows = [0.1, 0.5, 1.0].map(|depth| {
        let excess = -depth / libm::expm1(-depth);
        [0.0, depth, excess][1..].iter().map(|v| format::number(*v)).collect::<Vec<_>>()
    });
    body.table(
        "In-scattering of a step, by what is right",
        &["Optical depth of a step", "Times the right value"],
        step_rows.to_vec(),
    );

    let (world, settings) = lab.world(&recipe)?;
    let (scattered, expected, rays) = scattered_once(lab, &world, &settings)?;
    let (twice, depth) = (interactions(lab), 1.0);
    let law = -libm::expm1(-depth);
    let (share, right_share) = (0.5 * law * law, law);
    let off = 4.9 * libm::sqrt(share * (1.0 - share) / TRIED as f64);
    let bright = report_many.mean() / many.mean();
    body.numbers(vec![
        Number::within(
            "Power scattered once: photons by the integral along rays from the lamp",
            scattered / expected,
            "",
            lab.pick([0.98, 1.02], [0.93, 1.07]),
            &format!(
                "σ_s/σ_t (1 − e^(−σ_t d)) of each direction's light, from {rays} directions. The chance error is a part in \
                 two hundred, in the quick study in sixty. Asked twice it would be less than half; 1/σ_s at the wrong place makes \
                 it 16 times."
            ),
        ),
        Number::within(
            "Photons that interact within an optical depth of 1 by the report's text",
            twice,
            "",
            [share - off, share + off],
            &format!(
                "(1 − e^(−τ))²/2 within 4.9 standard deviations; it should be 1 − e^(−τ) = {}.",
                format::number(right_share)
            ),
        ),
        Number::within(
            "Mean of the report's march by that of the beam estimate, k = 300",
            bright,
            "",
            lab.pick([0.9, 1.2], [0.8, 1.3]),
            "Steps of the 128th part of the scene are too bright by some parts in a hundred; blur through walls darkens edges.",
        ),
    ]);
    body.finding(
        "Fig 3.7",
        "The lamp glows and the caustic is seen in the fog; more neighbours are smoother.",
        "Interactions must not be asked for twice; a step's light is τ/(1 − e^(−τ)) times the right one; 1/σ_s depends on where photons are \
         stored.",
        "The drawn distance has the probability in it already; light is lost within a step, too.",
    );
    Ok(body)
}

/// Draws of the report's rule.
const TRIED: u64 = 200_000;

/// The part of photons that interact within an optical depth of 1, if asked twice.
fn interactions(lab: &Lab) -> f64 {
    let mut numbers = lab.sampler(0x307);
    let mut one = || wrong::interacts_twice(1.0, [numbers.next_1d(), numbers.next_1d()].map(f64::from));
    (0..TRIED).filter(|_| one()).count() as f64 / TRIED as f64
}

/// The power in W that the fog scatters of the lamp's light before it meets anything: by photons, and by an integral over
/// directions.
fn scattered_once(lab: &Lab, world: &World, settings: &RenderSettings) -> Result<(f64, f64, u32), Stop> {
    let config = settings.method.mapper().cloned().unwrap_or_default();
    let config = PhotonMapperConfig {
        single_scatter: DirectSource::Map,
        photons: 1000,
        caustic_photons: 0,
        volume_photons: Some(lab.pick(200_000, 20_000)),
        ..config
    };
    let settings = RenderSettings { method: Method::PhotonMapper(config), ..settings.clone() };
    let recorded = record_photons(world, &settings, 0, lab.observer()).ok_or(Stop::Cancelled)?;
    let first = recorded.photons.iter().filter(|p| p.map == MapName::Volume && p.photon.depth == 1);
    let scattered: f64 = first.map(|p| f64::from(p.photon.power.mean())).sum();
    let (position, intensity) = tracer::lamp(world)?;
    let (mut numbers, rays) = (lab.sampler(0x370), lab.pick(400_000, 100_000));
    let mut sum = 0.0;
    for _ in 0..rays {
        let ray = Ray::new(position, warp::square_to_sphere(numbers.next_2d()));
        let end = world.intersect(&ray).map_or(0.0, |hit| f64::from(hit.t));
        sum += ALBEDO * -libm::expm1(-SIGMA_T * end);
    }
    let power = 4.0 * std::f64::consts::PI * f64::from(intensity.mean());
    Ok((scattered, power * sum / f64::from(rays), rays))
}
