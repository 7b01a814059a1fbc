//! Who is answered: a page of this very server, by the name of this very machine. A browser sends whatever a page that it shows asks for,
//! and a name's owner can have it lead anywhere, to here as well; both are told by what the browser says of them.

use std::net::{IpAddr, SocketAddr};
use std::sync::Arc;

use axum::extract::{Request, State};
use axum::http::header::{
    CACHE_CONTROL, CONTENT_SECURITY_POLICY, HOST, HeaderName, ORIGIN, REFERRER_POLICY,
    X_CONTENT_TYPE_OPTIONS, X_FRAME_OPTIONS,
};
use axum::http::{HeaderMap, HeaderValue, StatusCode, Uri};
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};

use super::page::policy;

/// The names that this server answers to.
pub(super) struct Allowed {
    address: SocketAddr,
    policy: HeaderValue,
}

impl Allowed {
    pub(super) fn new(address: SocketAddr) -> Arc<Self> {
        Arc::new(Allowed { address, policy: policy() })
    }

    /// Whether `host`, with its port, is one of them: localhost or an address. A name could be somebody else's.
    fn is_own(&self, host: &str) -> bool {
        // Without a port it is HTTP's own.
        let (name, port) = match host.rsplit_once(':') {
            Some((name, port)) if !port.ends_with(']') => (name, port.parse().ok()),
            _ => (host, Some(80)),
        };
        if port != Some(self.address.port()) {
            return false;
        }
        let bare = name.strip_prefix('[').and_then(|name| name.strip_suffix(']')).unwrap_or(name);
        let own = self.address.ip();
        match bare.parse::<IpAddr>() {
            // Whoever serves on all addresses is asked by any of them.
            Ok(ip) => ip == own || own.is_unspecified() || own.is_loopback() && ip.is_loopback(),
            Err(_) => name.eq_ignore_ascii_case("localhost") && (own.is_loopback() || own.is_unspecified()),
        }
    }

    /// Why a request isn't answered.
    fn refuses(&self, uri: &Uri, headers: &HeaderMap) -> Option<&'static str> {
        let text = |name: HeaderName| headers.get(name).map(|value| value.to_str().unwrap_or("?"));
        let hosts = headers.get_all(HOST).iter().count();
        if hosts != 1 || !text(HOST).is_some_and(|host| self.is_own(host)) {
            return Some("This server doesn't answer to that Host.");
        }
        if uri.authority().is_some_and(|authority| !self.is_own(authority.as_str())) {
            return Some("This server is no proxy.");
        }
        let own = |origin: &str| origin.strip_prefix("http://").is_some_and(|host| self.is_own(host));
        if text(ORIGIN).is_some_and(|origin| !own(origin)) {
            return Some("Only this server's own page may ask: foreign Origin.");
        }
        // Pictures in a foreign page come without an Origin. A link on one may lead here.
        let site = text(HeaderName::from_static("sec-fetch-site")).unwrap_or("none");
        let link = text(HeaderName::from_static("sec-fetch-mode")) == Some("navigate");
        (!["none", "same-origin"].contains(&site) && !link)
            .then_some("Only this server's own page may ask: foreign site.")
    }
}

/// Answers, or refuses; either with the headers that keep a page to itself.
pub(super) async fn check(State(allowed): State<Arc<Allowed>>, request: Request, next: Next) -> Response {
    let mut response = match allowed.refuses(request.uri(), request.headers()) {
        Some(why) => (StatusCode::FORBIDDEN, why).into_response(),
        None => next.run(request).await,
    };
    let headers = response.headers_mut();
    headers.insert(CONTENT_SECURITY_POLICY, allowed.policy.clone());
    for (name, value) in [
        (CACHE_CONTROL, "no-store"),
        (X_CONTENT_TYPE_OPTIONS, "nosniff"),
        (X_FRAME_OPTIONS, "DENY"),
        (REFERRER_POLICY, "no-referrer"),
        (HeaderName::from_static("cross-origin-resource-policy"), "same-origin"),
        (HeaderName::from_static("cross-origin-opener-policy"), "same-origin"),
    ] {
        headers.insert(name, HeaderValue::from_static(value));
    }
    response
}

#[cfg(test)]
mod tests {
    use super::*;

    fn allowed(address: &str) -> Arc<Allowed> {
        Allowed::new(address.parse().unwrap())
    }

    #[test]
    fn names_of_this_machine_alone_are_its_own() {
        let own = allowed("127.0.0.1:8000");
        for host in ["127.0.0.1:8000", "localhost:8000", "LocalHost:8000", "[::1]:8000", "127.0.0.2:8000"] {
            assert!(own.is_own(host), "{host}");
        }
        for host in [
            "evil.example:8000",
            "127.0.0.1:8001",
            "127.0.0.1",
            "127.0.0.1.evil.example:8000",
            "localhost.evil.example:8000",
            "192.168.1.5:8000",
            "localhost:x",
            "",
            ":8000",
            "[::1]",
        ] {
            assert!(!own.is_own(host), "{host}");
        }
        let everywhere = allowed("0.0.0.0:8000");
        assert!(everywhere.is_own("192.168.1.5:8000") && everywhere.is_own("localhost:8000"));
        assert!(!everywhere.is_own("evil.example:8000"));
        let one = allowed("192.168.1.5:80");
        assert!(one.is_own("192.168.1.5") && !one.is_own("localhost") && !one.is_own("127.0.0.1"));
    }

    #[test]
    fn foreign_pages_are_refused_and_links_followed() {
        let own = allowed("127.0.0.1:8000");
        let refused = |uri: &'static str, pairs: &[(&'static str, &'static str)]| {
            let pairs = pairs
                .iter()
                .map(|(name, value)| (HeaderName::from_static(name), HeaderValue::from_static(value)));
            let mut headers = HeaderMap::from_iter(pairs);
            headers.insert(HOST, HeaderValue::from_static("127.0.0.1:8000"));
            own.refuses(&Uri::from_static(uri), &headers).is_some()
        };
        assert!(!refused("/", &[]));
        assert!(!refused("/", &[("origin", "http://localhost:8000"), ("sec-fetch-site", "same-origin")]));
        for origin in ["http://evil.example", "null", "https://127.0.0.1:8000", "http://127.0.0.1:9"] {
            assert!(refused("/", &[("origin", origin)]), "{origin}");
        }
        assert!(refused("/", &[("sec-fetch-site", "cross-site"), ("sec-fetch-mode", "no-cors")]));
        assert!(!refused("/", &[("sec-fetch-site", "cross-site"), ("sec-fetch-mode", "navigate")]));
        assert!(refused("http://evil.example/", &[]));
        assert!(own.refuses(&Uri::from_static("/"), &HeaderMap::new()).is_some(), "no Host at all");
    }
}
