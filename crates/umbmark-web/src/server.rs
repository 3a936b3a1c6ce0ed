//! Requests and answers on loopback: one thread waits, others answer.

use std::convert::Infallible;
use std::net::TcpListener;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use bytes::Bytes;
use http_body_util::{BodyExt, Full, Limited};
use hyper::body::Incoming;
use hyper::header::{self, HeaderValue};
use hyper::server::conn::http1;
use hyper::service::service_fn;
use hyper::{Request, Response, StatusCode};
use hyper_util::rt::{TokioIo, TokioTimer};

use crate::app::{Answer, App, Asked};

/// A request is never longer \[bytes\]: logs of hours are shorter.
const LONGEST: usize = 1 << 30;
/// How often a wish to stop is looked for.
const LOOKS: Duration = Duration::from_millis(100);
/// A connection that says nothing is closed after this.
const HEADERS: Duration = Duration::from_secs(10);

/// What a page may load and ask: from this server only.
const POLICY: &str = "default-src 'none'; script-src 'self'; style-src 'self' 'unsafe-inline'; img-src 'self' data: blob:; \
                      connect-src 'self'; font-src 'self'; form-action 'none'; base-uri 'none'";

/// Answers until `stop` is set.
pub fn serve(app: &Arc<App>, listener: TcpListener, stop: &AtomicBool) -> std::io::Result<()> {
    listener.set_nonblocking(true)?;
    let runtime = tokio::runtime::Builder::new_current_thread().enable_io().enable_time().build()?;
    runtime.block_on(async {
        let listener = tokio::net::TcpListener::from_std(listener)?;
        while !stop.load(Ordering::Relaxed) {
            let Ok(accepted) = tokio::time::timeout(LOOKS, listener.accept()).await else { continue };
            // What one connection could not have, the next one may.
            let Ok((stream, _)) = accepted else { continue };
            let app = Arc::clone(app);
            tokio::spawn(async move {
                let service = service_fn(move |request| answer(Arc::clone(&app), request));
                let mut server = http1::Builder::new();
                server.timer(TokioTimer::new()).header_read_timeout(HEADERS);
                // A browser that goes away is no failure.
                let _ = server.serve_connection(TokioIo::new(stream), service).await;
            });
        }
        app.stop();
        Ok::<(), std::io::Error>(())
    })?;
    runtime.shutdown_timeout(Duration::from_secs(2));
    Ok(())
}

async fn answer(app: Arc<App>, request: Request<Incoming>) -> Result<Response<Full<Bytes>>, Infallible> {
    let (head, body) = request.into_parts();
    let admitted = app.guard.admit(&head.method, head.uri.path(), &head.headers).map(str::to_owned);
    let path = match admitted {
        Ok(path) => path,
        Err((status, why)) => return Ok(response(Answer::refused(status, why))),
    };
    let body = match Limited::new(body, LONGEST).collect().await {
        Ok(body) => body.to_bytes(),
        Err(_) => return Ok(response(Answer::refused(StatusCode::PAYLOAD_TOO_LARGE, "a file may have 1 GB at most"))),
    };
    let query = head.uri.query().unwrap_or_default().to_owned();
    let asked = Asked { method: head.method, path, query, body };
    let answered = tokio::task::spawn_blocking(move || app.answer(&asked)).await;
    Ok(response(answered.unwrap_or_else(|_| {
        Answer::refused(StatusCode::INTERNAL_SERVER_ERROR, "this could not be answered; what was done before is kept")
    })))
}

fn response(answer: Answer) -> Response<Full<Bytes>> {
    let mut response = Response::new(Full::new(Bytes::from(answer.body)));
    *response.status_mut() = answer.status;
    let headers = response.headers_mut();
    headers.insert(header::CONTENT_TYPE, HeaderValue::from_static(answer.kind));
    let fixed = [
        (header::CACHE_CONTROL, "no-store"),
        (header::CONTENT_SECURITY_POLICY, POLICY),
        (header::REFERRER_POLICY, "no-referrer"),
        (header::X_CONTENT_TYPE_OPTIONS, "nosniff"),
        (header::HeaderName::from_static("cross-origin-resource-policy"), "same-origin"),
        (header::HeaderName::from_static("cross-origin-opener-policy"), "same-origin"),
    ];
    // The report brings its own script along, and is looked at as a file.
    for (name, value) in fixed {
        headers.insert(name, HeaderValue::from_static(value));
    }
    if let Some(Ok(name)) =
        answer.download.map(|name| HeaderValue::from_str(&format!("attachment; filename=\"{name}\"")))
    {
        headers.insert(header::CONTENT_DISPOSITION, name);
    }
    response
}
