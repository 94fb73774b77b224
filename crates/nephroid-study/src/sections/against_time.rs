//! Errors of the methods against time, and where what the report left undone is found.

use nephroid::film::ImageError;
use nephroid::texture::Image;

use crate::body::{Body, Number};
use crate::chart::Chart;
use crate::format;
use crate::lab::{Lab, Render};
use crate::picture::{Look, Picture};
use crate::recipe::Recipe;
use crate::section::{Section, Stop, Weight};

/// What the report concludes, measured.
pub const SECTION: Section = Section {
    id: "chapter-4",
    report: "Chapter 4",
    title: "error against time, by method",
    weight: Weight { full: 200.0, quick: 8.0 },
    run,
};

/// Each with its name on the page.
const METHODS: [(&str, &str); 4] = [
    ("photon map", "photonmapper"),
    ("progressive photon mapping", "ppm"),
    ("vertex connection and merging", "vcm"),
    ("path tracing", "path"),
];

/// One scene: errors by method and budget, with seconds.
struct Race {
    curves: Vec<(&'static str, Vec<[f64; 3]>)>,
    reference: Render,
    least: Vec<Render>,
}

impl Race {
    fn error(&self, method: usize, budget: usize) -> f64 {
        self.curves[method].1[budget][2]
    }

    /// What an error falls by from the least to the largest budget.
    fn gain(&self, method: usize) -> f64 {
        let points = &self.curves[method].1;
        points[0][2] / points[points.len() - 1][2]
    }
}

fn race(lab: &Lab, recipe: &Recipe, reference: &Recipe) -> Result<Race, Stop> {
    let budgets: &[u32] = lab.pick(&[4, 16, 64, 256], &[4, 64]);
    let reference = lab.render(reference)?;
    let error = |image: &Image| {
        let error =
            ImageError::between(image, &reference.image, ImageError::EPSILON).map_err(Stop::because)?;
        Ok::<_, Stop>(error.rel_mse)
    };
    let (mut curves, mut least) = (Vec::new(), Vec::new());
    for (name, method) in METHODS {
        let mut curve = Vec::new();
        for &budget in budgets {
            let render = lab.render(&recipe.clone().flag("--integrator", method).flag("--spp", budget))?;
            curve.push([f64::from(budget), render.time.as_secs_f64(), error(&render.image)?]);
            if budget == budgets[1] {
                least.push(render);
            }
        }
        curves.push((name, curve));
    }
    Ok(Race { curves, reference, least })
}

fn run(lab: &Lab) -> Result<Body, Stop> {
    let side = lab.pick(96, 32);
    let sized = |scene: &str| lab.recipe(scene).side(side);
    // Of a seed of its own, so that it shares no photons and no paths with what is measured by it.
    let reference = Recipe::of_scene("cornell").side(side).flag("--seed", lab.seed() + 977);
    let reference = reference.flag("--integrator", "ppm").flag("--spp", lab.pick(1024, 256));
    let caustic = race(lab, &sized("cornell"), &reference)?;
    let reference = Recipe::of_scene("report-2-6").side(side).flag("--seed", lab.seed() + 977);
    let reference = reference.flag("--integrator", "path").flag("--spp", lab.pick(4096, 512));
    let diffuse = race(lab, &sized("report-2-6"), &reference)?;

    let most = caustic.curves[0].1.len() - 1;
    let mut body = Body::new();
    body.say(
        "The report concludes that photon mapping pleases the eye sooner than path tracing, and that path tracing is right in the \
         end. Both can be measured. The first scene has a glass ball, its caustic, and a mirror in which the caustic is seen; the \
         second is the report's diffuse box. Each method renders with ever more samples a pixel.",
    );
    body.say(
        &format!(
            "Where there are caustics the path tracer's error at the most samples is {} times the photon map's. In the diffuse box it is {} \
             times: it {}. There the photon map's own error falls by {} times only: samples do not make its photons \
             more, so its blur and its blotches stay. Progressive photon mapping and vertex connection and merging have new photons in \
             each pass and smaller radii; theirs fall by {} and {} times.",
            format::number(caustic.error(3, most) / caustic.error(0, most)),
            format::number(diffuse.error(3, most) / diffuse.error(0, most)),
            if diffuse.error(3, most) < diffuse.error(0, most) { "has caught up" } else { "has not caught up yet" },
            format::number(diffuse.gain(0)),
            format::number(diffuse.gain(1)),
            format::number(diffuse.gain(2)),
        ),
    );
    let look = Look::exposed(0.0);
    for (race, what) in
        [(&caustic, "A room with a glass and a mirror ball"), (&diffuse, "A diffuse box with two spheres")]
    {
        let pictures = race.least.iter().zip(METHODS).map(|(render, (name, _))| {
            let samples = render.statistics.samples_per_pixel;
            Picture::of(
                render,
                &look,
                &format!("{what}, {name}."),
                &format!("{name}, {samples} samples a pixel"),
            )
        });
        let reference = Picture::of(&race.reference, &look, &format!("{what}: the reference."), "Reference");
        body.strip(pictures.chain([reference]).collect::<Result<_, _>>()?);
        let chart = |x: &str, column: usize| {
            race.curves.iter().fold(
                Chart::new(x, "relMSE against the reference").logarithmic(),
                |chart, (name, points)| {
                    chart.points(name, points.iter().map(|p| (p[column], p[2])).collect())
                },
            )
        };
        let fall = |i: usize| format!("{} times for {}", format::rounded(race.gain(i), 3), METHODS[i].0);
        let falls = (0..METHODS.len()).map(fall).collect::<Vec<_>>().join(", ");
        body.plot(chart("seconds on this machine", 1).draw(
            &format!("{what}: error over time. From the least to the most samples it falls by {falls}."),
            &format!("{what}: error over measured time, photons included. Times are of this run and differ from machine to machine."),
        )?);
        let row = |(name, points): &(&str, Vec<[f64; 3]>)| {
            [vec![(*name).to_owned()], points.iter().map(|p| format::number(p[2])).collect()].concat()
        };
        let budgets: Vec<String> = race.curves[0].1.iter().map(|p| format!("{} samples", p[0])).collect();
        let head: Vec<&str> = ["Method"].into_iter().chain(budgets.iter().map(String::as_str)).collect();
        body.table(&format!("{what}: relMSE"), &head, race.curves.iter().map(row).collect());
    }
    let budgets = caustic.curves[0].1.len();
    let times = caustic.curves[0].1[budgets - 1][0] / caustic.curves[0].1[0][0];
    body.numbers(vec![
        Number::within(
            "Caustic: path tracing's error by the photon map's, fewest samples",
            caustic.error(3, 0) / caustic.error(0, 0),
            "",
            [2.0, f64::MAX],
            "The report's claim: the photon map pleases sooner. Paths meet the small lamp through glass by chance only.",
        ),
        Number::within(
            "Diffuse box: what path tracing's error falls by",
            diffuse.gain(3),
            "",
            [times / 2.5, times * libm::sqrt(times)],
            "At least about as many times as there are more samples, up to the error of the reference and the chance in both; \
             Sobol samples of smooth light may fall as n^−1.5.",
        ),
        Number::within(
            "Diffuse box: what the photon map's error falls by",
            diffuse.gain(0),
            "",
            [0.9, 0.3 * times],
            "It stops at the error of its 10 000 photons, which samples do not touch.",
        ),
        Number::within(
            "Diffuse box: progressive by classic photon map, most samples",
            diffuse.error(1, budgets - 1) / diffuse.error(0, budgets - 1),
            "",
            [0.0, 0.5],
            "New photons in each pass, and smaller radii.",
        ),
        Number::measured(
            "Stated error of the reference, caustic",
            100.0 * caustic.reference.error()?,
            "%",
            "Errors near its square are not told from it.",
        ),
        Number::measured("Stated error of the reference, diffuse", 100.0 * diffuse.reference.error()?, "%", "The same."),
    ]);
    body.finding(
        "Chapter 4: conclusions",
        "Photon mapping shows caustics in a fraction of the samples; path tracing is right in the end.",
        "Photon mapping need not stay biased: with passes and shrinking radii it goes on to the truth.",
        "The blur of a map is as wide as its radius, and radii can shrink as photons grow.",
    );
    body.finding(
        "Fig 5.1",
        "181 hours of work on their project, by part.",
        "Nothing.",
        "A diagram of hours: there is nothing to render.",
    );
    left_undone(&mut body);
    Ok(body)
}

/// What the report names as not done, and where it is.
fn left_undone(body: &mut Body) {
    let rows = [
        (
            "Area lights",
            "nephroid render cornell: a square lamp, by rays to its surface and by photons from it",
        ),
        ("Glossy materials, rendered", "bsdf phong; see Question 2.6"),
        (
            "Anisotropic phase functions",
            "nephroid render fog-forward and fog-backward: Henyey and Greenstein's, sampled by itself",
        ),
        ("Heterogeneous media", "nephroid render smoke: extinction on a grid"),
        (
            "Adaptive ray marching",
            "volume_estimate=march: steps as long as the estimate blurs; and the beam estimate, which has no steps",
        ),
        ("Emission in media", "media that give off light are lamps, for photons and for rays"),
        ("Media tested deeper", "closed forms of the library's tests, and Figs 3.6 to 3.10 here"),
        ("Kernels on harder scenes", "Section 3.2 here"),
        (
            "Textures and other geometry (done in the authors' path tracer)",
            "images, checkerboards, meshes, instances, cylinders, discs, cubes",
        ),
    ];
    let rows = rows.map(|(what, place)| vec![what.to_owned(), place.to_owned()]);
    body.table("What the report names as not done, and where it is", &["Left undone", "Now"], rows.to_vec());
    body.finding(
        "Left undone: area lights, Phong renders, phase functions, heterogeneous media, adaptive marching, emission, tests of media, \
         kernels; textures and geometry, which the authors had in their path tracer",
        "All of it is named by the report as not in its photon mapper.",
        "All of it is there.",
        "The table in this section says where.",
    );
}
