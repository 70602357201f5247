//! How much a share among a few runs says.

/// The 95 % interval of a share, of which `count` of `of` were seen. NaN if none was looked at.
///
/// Source: Wilson (1927), Probable inference, the law of succession, and statistical inference, *Journal of the American
/// Statistical Association* 22.
pub fn share_interval(count: usize, of: usize) -> [f64; 2] {
    const Z: f64 = 1.959_963_984_540_054;
    let (n, share) = (of as f64, count as f64 / of as f64);
    let middle = share + Z * Z / (2.0 * n);
    let half = Z * libm::sqrt(share * (1.0 - share) / n + Z * Z / (4.0 * n * n));
    [middle - half, middle + half].map(|end| (end / (1.0 + Z * Z / n)).clamp(0.0, 1.0))
}
