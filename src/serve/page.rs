//! The page, and what it may do.

use axum::http::HeaderValue;
use sha2::{Digest, Sha256};

/// The whole page: markup, style and script.
pub(super) const PAGE: &str = include_str!("page.html");

/// Nothing but what the page itself has: its style and its script by their hashes, pictures of this server.
pub(super) fn policy() -> HeaderValue {
    let hash = |tag: &str| {
        let inside =
            PAGE.split_once(&format!("<{tag}>")).and_then(|(_, rest)| rest.split_once(&format!("</{tag}>")));
        format!("'sha256-{}'", base64(&Sha256::digest(inside.map_or("", |(inside, _)| inside))))
    };
    let policy = format!(
        "default-src 'none'; script-src {}; style-src {}; img-src 'self' blob:; connect-src 'self'; base-uri 'none'; \
         form-action 'none'; frame-ancestors 'none'",
        hash("script"),
        hash("style")
    );
    HeaderValue::from_str(&policy).expect("visible ASCII")
}

/// As a policy spells a hash (RFC 4648).
fn base64(bytes: &[u8]) -> String {
    const LETTERS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let four = |three: &[u8]| {
        let bits = (0..3).fold(0, |bits, k| bits << 8 | usize::from(three.get(k).copied().unwrap_or(0)));
        let letter = |k: usize| if k > three.len() { '=' } else { LETTERS[bits >> (18 - 6 * k) & 63].into() };
        (0..4).map(letter).collect::<String>()
    };
    bytes.chunks(3).map(four).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The rows of RFC 4648, section 10.
    #[test]
    fn base64_is_that_of_the_rfc() {
        for (text, coded) in [
            ("", ""),
            ("f", "Zg=="),
            ("fo", "Zm8="),
            ("foo", "Zm9v"),
            ("foob", "Zm9vYg=="),
            ("fooba", "Zm9vYmE="),
            ("foobar", "Zm9vYmFy"),
        ] {
            assert_eq!(base64(text.as_bytes()), coded);
        }
    }

    #[test]
    fn the_page_asks_for_nothing_from_elsewhere() {
        assert!(!PAGE.contains("http://") && !PAGE.contains("https://") && !PAGE.contains(" style="));
        assert_eq!((PAGE.matches("<script>").count(), PAGE.matches("<style>").count()), (1, 1));
        let policy = policy();
        // Hashes of nothing would be those of a page without either.
        let nothing = base64(&Sha256::digest(""));
        assert!(!policy.to_str().unwrap().contains(&nothing));
    }
}
