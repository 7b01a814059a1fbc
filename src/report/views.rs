//! Views beside their photographs and the difference: pictures in a folder, and their part of a page.

use std::path::Path;

use image::RgbImage;
use ndarray::Array3;

use super::page::Page;
use crate::error::Result;
use crate::evaluation::ViewScore;
use crate::files::picture;

/// Differences are shown so many times as large.
const LOUDER: f32 = 4.0;
/// Width of a picture on the page.
const WIDTH: u32 = 280;

/// A view with its score, and where its pictures are, beside the page.
pub(crate) struct Shown {
    /// Its frame's name, PSNR and SSIM.
    pub score: ViewScore,
    /// The view, the photograph and the difference.
    pub files: [String; 3],
}

/// |view - photograph|, louder, black where they agree.
fn difference(view: &Array3<f32>, photograph: &Array3<f32>) -> RgbImage {
    let off = (view.mapv(|x| x.clamp(0.0, 1.0)) - photograph).mapv(|x| LOUDER * x.abs());
    picture::to_rgb(off.view())
}

/// Writes photograph and difference beside a view, to the second and third of these files.
///
/// # Errors
/// Where a file can't be written.
pub(crate) fn write(
    folder: &Path,
    files: &[String; 3],
    view: &Array3<f32>,
    photograph: &Array3<f32>,
) -> Result<()> {
    picture::write_png(&folder.join(&files[1]), photograph.view())?;
    picture::write_rgb(&folder.join(&files[2]), &difference(view, photograph))
}

/// Adds all views, the worst first.
pub(crate) fn add(page: &mut Page, mut views: Vec<Shown>) {
    views.sort_by(|a, b| a.score.psnr.total_cmp(&b.score.psnr));
    page.heading("Views, the worst first");
    if views.is_empty() {
        page.paragraph("No view has been rendered yet.");
        return;
    }
    page.paragraph(&format!("The view, its photograph, and how far they are apart, {LOUDER} times as bright: black is no difference."));
    let rows: Vec<Vec<String>> = views
        .iter()
        .map(|Shown { score, .. }| {
            let ssim = score.ssim.map_or("-".into(), |ssim| format!("{ssim:.4}"));
            vec![score.name.clone(), format!("{:.2}", score.psnr), ssim]
        })
        .collect();
    page.table(&["view", "PSNR dB", "SSIM"], &rows);
    for (Shown { score, files }, row) in views.iter().zip(&rows) {
        page.part(&format!("{}: {} dB, SSIM {}", score.name, row[1], row[2]));
        let [view, photograph, difference] = files;
        page.pictures(
            &score.name,
            &[(view, "view"), (photograph, "photograph"), (difference, "difference")],
            WIDTH,
        );
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_worst_view_comes_first_and_differences_are_loud() {
        let shown = |name: &str, psnr| Shown {
            score: ViewScore { name: name.into(), mse: 0.0, psnr, ssim: None },
            files: ["a.png", "b.png", "c.png"].map(String::from),
        };
        let mut page = Page::new("x", "y");
        add(&mut page, vec![shown("good", 30.0), shown("bad", 12.0)]);
        let text = page.finish();
        assert!(text.find("bad: 12.00 dB").unwrap() < text.find("good: 30.00 dB").unwrap());
        let (view, photograph) = (Array3::from_elem((1, 1, 3), 0.5), Array3::from_elem((1, 1, 3), 0.4));
        assert_eq!(difference(&view, &photograph)[(0, 0)].0, [102; 3]);
    }
}
