//! MCAP logs into the dataset type: `cargo bench -p umbmark-benches --bench mcap_log`; throughput is in bytes of unpacked
//! messages per second, on one thread.

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use mcap::Compression;
use umbmark_benches::mcap_logs::{READ, message_bytes, rewrite, write};

fn reading(criterion: &mut Criterion) {
    let folder = tempfile::tempdir().expect("a folder");
    let all = folder.path().join("all.mcap");
    write(&all);
    let topics = ["/joint_states", "/odom", "/tf", "/ground_truth"];
    let packings = [("zstd", Some(Compression::Zstd)), ("lz4", Some(Compression::Lz4)), ("not packed", None)];
    let mut group = criterion.benchmark_group("mcap");
    group.sample_size(10);
    for (what, topics) in [("four topics", &topics[..]), ("wheels and poses alone", &READ[..])] {
        for (packing, compression) in packings {
            let file = folder.path().join("run.mcap");
            rewrite(&all, &file, topics, compression);
            group.throughput(Throughput::Bytes(message_bytes(&file)));
            group.bench_function(format!("{what}, {packing}"), |bencher| {
                bencher.iter(|| umbmark_io::load(&file).expect("a good log"));
            });
        }
    }
    group.finish();
}

criterion_group!(benches, reading);
criterion_main!(benches);
