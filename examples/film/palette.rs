//! A palette for many pictures: groups of similar colours, split where they differ most until there are enough.

use std::collections::HashMap;

/// Red, green and blue.
pub(crate) type Color = [u8; 3];

/// The colours of an indexed picture.
pub(crate) struct Palette {
    pub(crate) colors: Vec<Color>,
    places: HashMap<Color, u8>,
}

impl Palette {
    /// At most `most` colours in place of those that are counted, each the mean of a group.
    pub(crate) fn new(counts: HashMap<Color, u64>, most: u8) -> Self {
        let mut all: Vec<(Color, u64)> = counts.into_iter().collect();
        // The same file each time, whatever the order in the map.
        all.sort_unstable();
        let mut groups = vec![Group::new(all)];
        while groups.len() < usize::from(most) {
            let worst = (0..groups.len()).max_by(|a, b| groups[*a].spread.total_cmp(&groups[*b].spread));
            let Some(worst) = worst.filter(|group| groups[*group].spread > 0.0) else { break };
            let above = groups[worst].split();
            groups.push(above);
        }
        let places =
            groups.iter().zip(0..).flat_map(|(group, place)| group.colors.iter().map(move |(c, _)| (*c, place)));
        Self { colors: groups.iter().map(Group::mean).collect(), places: places.collect() }
    }

    /// The place of a colour in the palette.
    pub(crate) fn place(&self, color: Color) -> u8 {
        self.places.get(&color).copied().unwrap_or(0)
    }
}

/// Similar colours with their counts.
struct Group {
    colors: Vec<(Color, u64)>,
    /// The channel in which they differ most, its mean, and the sum of the squared distances from there.
    channel: usize,
    mean: f64,
    spread: f64,
}

impl Group {
    fn new(colors: Vec<(Color, u64)>) -> Self {
        let channels = (0..3).map(|channel| {
            let mean = mean(&colors, channel);
            let spread = colors.iter().map(|(c, n)| (f64::from(c[channel]) - mean).powi(2) * *n as f64).sum::<f64>();
            (channel, mean, spread)
        });
        let widest = channels.max_by(|a, b| a.2.total_cmp(&b.2));
        let (channel, mean, spread) = widest.unwrap_or_default();
        Self { colors, channel, mean, spread }
    }

    /// Keeps the colours below the mean and returns those above.
    fn split(&mut self) -> Self {
        let Self { colors, channel, mean, .. } = self;
        let (above, below) = colors.drain(..).partition(|(color, _)| f64::from(color[*channel]) > *mean);
        *self = Self::new(below);
        Self::new(above)
    }

    fn mean(&self) -> Color {
        [0, 1, 2].map(|channel| mean(&self.colors, channel).round() as u8)
    }
}

/// The mean of a channel.
fn mean(colors: &[(Color, u64)], channel: usize) -> f64 {
    let all: u64 = colors.iter().map(|(_, count)| count).sum();
    let sum: u64 = colors.iter().map(|(color, count)| u64::from(color[channel]) * count).sum();
    sum as f64 / all.max(1) as f64
}
