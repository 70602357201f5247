//! Which model: seven plants, each filtered by all seven as model classes, and the share of seeds in which the right one is found.
//!
//! ```text
//! cargo run --release -p kalmanscope-core --example model_classes -- [SEEDS [FIRST]]
//! ```
//!
//! Each row is a true plant. The columns: the share of seeds in which its own class has a probability of at least 95 % at the end,
//! the median of the times from which on it keeps 95 %, and the mean probability of each class at the end.

use std::error::Error;

use kalmanscope_core::{Evidence, ModelClasses, Run, Scenario};

/// Key, truth, and the mean and standard deviation that a filter believes at first.
type Parameter = (&'static str, f64, f64, f64);

/// A plant as truth and as class.
struct Class {
    name: &'static str,
    plant: &'static str,
    /// Those besides the oscillator's, or all of another motion.
    parameters: &'static [Parameter],
}

const OSCILLATOR: [Parameter; 2] = [("natural_frequency", 6.0, 7.0, 2.0), ("damping_ratio", 0.05, 0.1, 0.1)];

const CLASSES: [Class; 7] = [
    Class { name: "linear", plant: "kind = \"sdof\"", parameters: &[] },
    Class { name: "Duffing", plant: "kind = \"duffing\"", parameters: &[("cubic_stiffness", 200.0, 0.0, 200.0)] },
    Class {
        name: "Bouc-Wen",
        plant: "kind = \"bouc_wen\"",
        parameters: &[
            ("post_yield_ratio", 0.1, 0.1, 0.0),
            ("hysteresis_beta", 60.0, 50.0, 30.0),
            ("hysteresis_gamma", 40.0, 25.0, 30.0),
        ],
    },
    Class {
        name: "dry friction",
        plant: "equation = \"x'' + 2 ζ ωₙ x' + ωₙ² x + d tanh(x'/0.05) = f\"\nparameters = { d = { guess = 0.5, sign = \"not_negative\" } }",
        parameters: &[("d", 1.0, 0.5, 0.5)],
    },
    Class {
        name: "drag",
        plant: "equation = \"x'' + 2 ζ ωₙ x' + ωₙ² x + c x' abs(x') = f\"\nparameters = { c = { guess = 0.5, sign = \"not_negative\" } }",
        parameters: &[("c", 1.0, 0.5, 0.5)],
    },
    Class { name: "pendulum", plant: "equation = \"x'' + 2 ζ ωₙ x' + ωₙ² sin(x) = f\"", parameters: &[] },
    Class {
        name: "two masses",
        plant: "equation = \"x1'' = f - k x1 - c x1' + q (x2 - x1) + c (x2' - x1'); x2'' = - q (x2 - x1) - c (x2' - x1')\"\nparameters = { k = { guess = 40.0 }, q = { guess = 80.0 }, c = { guess = 0.5 } }",
        parameters: &[("k", 36.0, 40.0, 10.0), ("q", 60.0, 80.0, 30.0), ("c", 0.4, 0.5, 0.3)],
    },
];

impl Class {
    fn written(&self, of: fn(&Parameter) -> f64, between: &str) -> String {
        let own = self.parameters.iter().chain(if self.name == "two masses" { &[][..] } else { &OSCILLATOR });
        own.map(|parameter| format!("{} = {:?}", parameter.0, of(parameter))).collect::<Vec<_>>().join(between)
    }

    fn filter(&self) -> String {
        let lines = self.plant.replace('\n', ", ");
        let plant = if lines.starts_with("kind") { lines.replace("kind = ", "") } else { format!("{{ {lines} }}") };
        let [mean, std] = [(|of| of.2) as fn(&Parameter) -> f64, |of| of.3].map(|of| self.written(of, ", "));
        format!(
            "\n[[filters]]\nname = \"{}\"\nkind = \"ukf\"\nplant = {plant}\ninitial_mean = {{ {mean} }}\ninitial_std = {{ {std} }}\n",
            self.name
        )
    }

    /// The truth of this class, and a filter of every class.
    fn scenario(&self, seed: u64) -> String {
        let filters: String = CLASSES.iter().map(Self::filter).collect();
        format!(
            "seed = {seed}\ndt = 0.01\nduration = 60.0\n[plant]\n{}\n{}\n[force]\nwhite_noise = {{ std = 20.0 }}\n\
             [[sensors]]\nmeasures = \"displacement\"\nnoise_std = 0.01\n[[sensors]]\nmeasures = \"velocity\"\nnoise_std = 0.06\n{filters}",
            self.plant,
            self.written(|of| of.1, "\n")
        )
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1).map(|text| text.parse::<u64>());
    let (seeds, first) = (arguments.next().transpose()?.unwrap_or(200), arguments.next().transpose()?.unwrap_or(1));
    println!(
        "{:14}{:>9}{:>9}   mean probabilities of {}",
        "truth",
        "found %",
        "median s",
        CLASSES.map(|class| class.name).join(", ")
    );
    for (place, class) in CLASSES.iter().enumerate() {
        let (mut found, mut mean, mut since) = (0, [0.0; CLASSES.len()], Vec::new());
        for seed in first..first + seeds {
            let scenario = Scenario::from_toml(&class.scenario(seed))?;
            let mut run = Run::new(&scenario)?;
            run.finish();
            let evidence: Vec<Evidence> = run.estimates().iter().map(Evidence::new).collect();
            let at = |k: usize| ModelClasses::new(evidence.iter().map(|of| of.at(k).unwrap_or(f64::NAN)));
            let last = at(run.len() - 1);
            mean.iter_mut().zip(&last.probabilities).for_each(|(sum, p)| *sum += p / seeds as f64);
            let doubtful = (0..run.len()).rev().find(|k| at(*k).probabilities[place] < 0.95);
            if last.probabilities[place] >= 0.95 {
                found += 1;
                since.push(doubtful.map_or(0.0, |k| run.record().time(k)));
            }
        }
        since.sort_by(f64::total_cmp);
        let median = since.get(since.len() / 2).copied().unwrap_or(f64::INFINITY);
        let mean = mean.map(|p| format!("{p:.3}")).join(" ");
        println!("{:14}{:>9.1}{median:>9.1}   {mean}", class.name, 100.0 * f64::from(found) / seeds as f64);
    }
    Ok(())
}
