//! One file with a view in 3D of cameras, rays and samples, which opens from disk: styles, script, three.js and data inside.
//!
//! The scripts are in `space/`, joined in this order into one module; three.js (`vendor/three`) is text in the page that the module
//! loads, since a page from disk may load no other file.

use std::io::Cursor;

use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use image::codecs::jpeg::JpegEncoder;
use image::{RgbImage, imageops};
use serde_json::{Value, json};

use crate::files::picture;
use crate::scene::Frame;

const THREE: &str = include_str!("vendor/three/three.module.min.js");
const STYLES: [&str; 2] = [include_str!("style.css"), include_str!("space/style.css")];
const BODY: &str = include_str!("space/page.html");
const SCRIPTS: [&str; 9] = [
    "const three = await import(URL.createObjectURL(new Blob([document.getElementById(\"three\").textContent], { type: \"text/javascript\" })));\n",
    include_str!("space/data.js"),
    include_str!("space/stage.js"),
    include_str!("space/things.js"),
    include_str!("space/orbit.js"),
    include_str!("space/pick.js"),
    include_str!("space/plot.js"),
    include_str!("space/panel.js"),
    include_str!("space/main.js"),
];

/// Longest side of a photograph on the page, and of all of them together.
const PHOTOGRAPH: u32 = 128;
const ATLAS: u32 = 2048;

/// The page of what `data` says: see `data.js` and `main.js` for its fields.
pub(crate) fn html(data: &Value) -> String {
    // No text of the data ends the element that it is in.
    let text = data.to_string().replace('<', "\\u003c");
    let (style, script) = (STYLES.concat(), SCRIPTS.concat());
    [
        "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"><title>Cameras, rays and samples</title>\n<style>",
        &style,
        "</style></head><body class=\"space\">\n",
        BODY,
        "<script type=\"application/json\" id=\"data\">",
        &text,
        "</script>\n<script type=\"text/plain\" id=\"three\">",
        THREE,
        "</script>\n<script type=\"module\">\n",
        &script,
        "</script></body></html>\n",
    ]
    .concat()
}

/// Bytes as text.
pub(crate) fn base64(bytes: &[u8]) -> String {
    BASE64_STANDARD.encode(bytes)
}

/// All photographs in one picture, row by row, each in a place of the same size; gray where there is none.
pub(crate) fn atlas(frames: &[&Frame]) -> Value {
    let columns = (frames.len() as f64).sqrt().ceil() as u32;
    let rows = (frames.len() as u32).div_ceil(columns);
    let longest = PHOTOGRAPH.min(ATLAS / columns).max(8);
    let camera = frames[0].camera;
    let (w, h) = (camera.width as f64, camera.height as f64);
    let side = |side: f64| (side * (f64::from(longest) / w.max(h)).min(1.0)).round().max(1.0) as u32;
    let (width, height) = (side(w), side(h));
    let mut all = RgbImage::from_pixel(columns * width, rows * height, image::Rgb([128; 3]));
    for (n, frame) in (0i64..).zip(frames) {
        let Some(image) = &frame.image else { continue };
        let whole = picture::to_rgb(image.to_array().view());
        let small = imageops::resize(&whole, width, height, imageops::FilterType::Triangle);
        let (i, j) = (n % i64::from(columns), n / i64::from(columns));
        imageops::replace(&mut all, &small, i * i64::from(width), j * i64::from(height));
    }
    let mut bytes = Cursor::new(vec![]);
    all.write_with_encoder(JpegEncoder::new_with_quality(&mut bytes, 85)).expect("written to memory");
    let picture = format!("data:image/jpeg;base64,{}", base64(bytes.get_ref()));
    json!({"columns": columns, "rows": rows, "width": width, "height": height, "picture": picture})
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_name_ends_the_script_that_it_is_in() {
        let page = html(&json!({"title": "</script><script>alert(1)</script>"}));
        assert_eq!(page.matches("</script>").count(), 3);
        assert!(page.contains("\\u003c/script>\\u003cscript>alert"));
    }

    #[test]
    fn three_is_the_file_that_its_note_names() {
        use sha2::{Digest, Sha256};
        let hash: String = Sha256::digest(THREE).iter().map(|byte| format!("{byte:02x}")).collect();
        assert!(include_str!("vendor/three/SOURCE.md").contains(&hash), "{hash}");
        // It stands in the page as it is.
        assert!(!THREE.contains("</script") && !THREE.contains("<!--"));
    }
}
