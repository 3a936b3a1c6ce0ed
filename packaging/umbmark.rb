# The formula for Homebrew. A release fills in the checksums (`.ci/release.py finish`).
class Umbmark < Formula
  desc "Measure, explain and correct the odometry error of wheeled robots"
  homepage "https://github.com/umbmark/umbmark"
  version "0.1.0"
  license any_of: ["MIT", "Apache-2.0"]

  on_macos do
    on_arm do
      url "https://github.com/umbmark/umbmark/releases/download/v#{version}/umbmark-#{version}-aarch64-apple-darwin.tar.gz"
      sha256 "0000000000000000000000000000000000000000000000000000000000000000"
    end
    on_intel do
      url "https://github.com/umbmark/umbmark/releases/download/v#{version}/umbmark-#{version}-x86_64-apple-darwin.tar.gz"
      sha256 "0000000000000000000000000000000000000000000000000000000000000000"
    end
  end

  on_linux do
    on_arm do
      url "https://github.com/umbmark/umbmark/releases/download/v#{version}/umbmark-#{version}-aarch64-unknown-linux-gnu.tar.gz"
      sha256 "0000000000000000000000000000000000000000000000000000000000000000"
    end
    on_intel do
      url "https://github.com/umbmark/umbmark/releases/download/v#{version}/umbmark-#{version}-x86_64-unknown-linux-gnu.tar.gz"
      sha256 "0000000000000000000000000000000000000000000000000000000000000000"
    end
  end

  def install
    bin.install "umbmark"
    man1.install "man/umbmark.1"
    bash_completion.install "completions/umbmark.bash" => "umbmark"
    zsh_completion.install "completions/_umbmark"
    fish_completion.install "completions/umbmark.fish"
  end

  test do
    assert_match version.to_s, shell_output("#{bin}/umbmark --version")
    assert_match "\"n\": 100", shell_output("#{bin}/umbmark mc --ed 1.002 -n 100 --json")
  end
end
