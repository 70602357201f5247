//! Files that leave the page as downloads.

use std::fs;
use std::path::Path;
use std::time::{Duration, Instant};

use crate::page::Page;

/// Limits the time until a download is there.
const PATIENCE: Duration = Duration::from_secs(30);

/// A figure and the estimates come as downloads with their contents.
pub(crate) async fn a_figure_is_downloaded(page: &Page, folder: &Path) {
    fs::create_dir_all(folder).unwrap();
    page.allow_downloads(folder).await;
    let svg = downloaded(page, folder, "Paper, 84 mm (SVG)", "kalmanscope-84mm.svg").await;
    let svg = String::from_utf8(svg).unwrap();
    assert!(svg.starts_with("<svg ") && svg.trim_end().ends_with("</svg>") && svg.contains("width=\"84mm\""), "{svg}");
    assert!(svg.contains("natural frequency") && !svg.contains("NaN"), "the views on screen are in it");
    let estimates = downloaded(page, folder, "Estimates (CSV)", "estimates.csv").await;
    assert!(estimates.starts_with(b"filter,k,t,"), "{}", String::from_utf8_lossy(&estimates[..80]));
}

/// Chooses an entry of the menu, and waits for the file.
pub(crate) async fn downloaded(page: &Page, folder: &Path, entry: &str, name: &str) -> Vec<u8> {
    page.click("Export", 0.5).await;
    page.click(entry, 0.5).await;
    let (path, begun) = (folder.join(name), Instant::now());
    while !path.is_file() {
        assert!(begun.elapsed() < PATIENCE, "{name} has not come");
        tokio::time::sleep(Duration::from_millis(100)).await;
    }
    println!("{name}: {} bytes after {:.1} s", fs::metadata(&path).unwrap().len(), begun.elapsed().as_secs_f64());
    fs::read(path).unwrap()
}
