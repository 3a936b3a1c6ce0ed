//! Who may ask: only pages that this server sent, from this machine.

use hyper::header::{HOST, HeaderMap, HeaderName, ORIGIN};
use hyper::{Method, StatusCode};

/// Says which site a request comes from; browsers set it, and pages cannot.
const SITE: HeaderName = HeaderName::from_static("sec-fetch-site");
const MODE: HeaderName = HeaderName::from_static("sec-fetch-mode");

/// What may be asked, and of whom.
#[derive(Clone, Debug)]
pub struct Guard {
    /// The first part of every address.
    pub token: String,
    /// The port that is listened to.
    pub port: u16,
}

/// Why a request is refused.
pub type Refusal = (StatusCode, &'static str);

impl Guard {
    /// A guard with a token that nobody can guess: 128 random bits.
    pub fn new(port: u16) -> Result<Guard, getrandom::Error> {
        let mut random = [0; 16];
        getrandom::fill(&mut random)?;
        Ok(Guard { token: random.iter().map(|byte| format!("{byte:02x}")).collect(), port })
    }

    /// The address of the page.
    pub fn address(&self) -> String {
        format!("http://127.0.0.1:{}/{}/", self.port, self.token)
    }

    /// The part of a path behind the token, or why it is refused.
    pub fn admit<'p>(&self, method: &Method, path: &'p str, headers: &HeaderMap) -> Result<&'p str, Refusal> {
        if !self.is_own(headers.get(HOST).map(|host| host.as_bytes())) {
            return Err((StatusCode::MISDIRECTED_REQUEST, "this server answers for 127.0.0.1 only"));
        }
        if let Some(origin) = headers.get(ORIGIN) {
            let host = origin.as_bytes().strip_prefix(b"http://");
            if !self.is_own(host) {
                return Err((StatusCode::FORBIDDEN, "another page may not ask this server"));
            }
        }
        let other = |value: &[u8]| value != b"same-origin" && value != b"none";
        let navigates = headers.get(MODE).is_some_and(|mode| mode.as_bytes() == b"navigate") && method == Method::GET;
        if headers.get(SITE).is_some_and(|site| other(site.as_bytes())) && !navigates {
            return Err((StatusCode::FORBIDDEN, "another page may not ask this server"));
        }
        let wrong =
            (StatusCode::FORBIDDEN, "the token in the address is wrong; take the address that the command printed");
        let (token, rest) = path.strip_prefix('/').and_then(|path| path.split_once('/')).ok_or(wrong)?;
        if !same(token.as_bytes(), self.token.as_bytes()) {
            return Err(wrong);
        }
        match *method {
            Method::GET | Method::POST => Ok(rest),
            _ => Err((StatusCode::METHOD_NOT_ALLOWED, "only GET and POST are understood")),
        }
    }

    fn is_own(&self, host: Option<&[u8]>) -> bool {
        let own = ["127.0.0.1", "localhost"].map(|name| format!("{name}:{}", self.port));
        host.is_some_and(|host| own.iter().any(|own| own.as_bytes() == host))
    }
}

/// Whether two texts are the same, in a time that does not tell where they differ.
fn same(a: &[u8], b: &[u8]) -> bool {
    a.len() == b.len() && a.iter().zip(b).fold(0, |sum, (a, b)| sum | (a ^ b)) == 0
}

#[cfg(test)]
mod tests {
    use super::*;
    use hyper::header::HeaderValue;

    fn asked(path: &str, headers: &[(&'static str, &str)]) -> Result<String, StatusCode> {
        let guard = Guard { token: "0123".into(), port: 8000 };
        let mut map = HeaderMap::new();
        for (name, value) in headers {
            map.insert(HeaderName::from_static(name), HeaderValue::from_str(value).unwrap());
        }
        guard.admit(&Method::GET, path, &map).map(str::to_owned).map_err(|(status, _)| status)
    }

    #[test]
    fn a_page_of_this_server_is_answered() {
        for host in ["127.0.0.1:8000", "localhost:8000"] {
            assert_eq!(asked("/0123/api/state", &[("host", host)]), Ok("api/state".into()));
        }
        let own = [("host", "127.0.0.1:8000"), ("origin", "http://127.0.0.1:8000"), ("sec-fetch-site", "same-origin")];
        assert_eq!(asked("/0123/", &own), Ok(String::new()));
    }

    #[test]
    fn a_wrong_token_is_refused_as_is_none() {
        for path in ["/0124/", "/012/", "/01234/", "/", "//", "/api/state", "/0123"] {
            assert_eq!(asked(path, &[("host", "127.0.0.1:8000")]), Err(StatusCode::FORBIDDEN), "{path}");
        }
    }

    #[test]
    fn a_name_that_leads_here_from_elsewhere_is_refused() {
        for host in ["evil.example:8000", "127.0.0.1:8001", "127.0.0.1", "127.0.0.1:8000.evil.example", ""] {
            assert_eq!(asked("/0123/", &[("host", host)]), Err(StatusCode::MISDIRECTED_REQUEST), "{host}");
        }
        assert_eq!(asked("/0123/", &[]), Err(StatusCode::MISDIRECTED_REQUEST));
    }

    #[test]
    fn another_page_is_refused_even_if_it_knows_the_token() {
        for origin in ["http://evil.example", "https://127.0.0.1:8000", "http://127.0.0.1:8001", "null"] {
            let headers = [("host", "127.0.0.1:8000"), ("origin", origin)];
            assert_eq!(asked("/0123/", &headers), Err(StatusCode::FORBIDDEN), "{origin}");
        }
        let headers = [("host", "127.0.0.1:8000"), ("sec-fetch-site", "cross-site")];
        assert_eq!(asked("/0123/api/state", &headers), Err(StatusCode::FORBIDDEN));
    }

    #[test]
    fn tokens_differ_and_are_long() {
        let [a, b] = [1, 2].map(|port| Guard::new(port).unwrap().token);
        assert!(a != b && a.len() == 32 && a.bytes().all(|byte| byte.is_ascii_hexdigit()));
    }
}
