#include "study/run_index.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <iterator>
#include <string_view>
#include <system_error>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include "physics/core/atomic_file.h"
#include "physics/core/error.h"
#include "physics/core/folder.h"
#include "physics/core/hash.h"
#include "physics/core/read_budget.h"

namespace crossgait {
namespace {

constexpr std::array<char, 24> kMagic{"crossgait run index 1\n"};
constexpr std::size_t kSeam = 4096;  // bytes by which a store is known again

/// A regular file that is open for reading, at any place.
class RandomAccessFile {
 public:
  explicit RandomAccessFile(const std::string& path) : path_(path) {
    check_file_name(path);
    file_ = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    if (file_ < 0) fail(errno == ENOENT ? "none" : std::generic_category().message(errno));
    if (::fstat(file_, &status_) == 0 && S_ISREG(status_.st_mode)) return;
    ::close(file_);
    fail(S_ISDIR(status_.st_mode) ? "a folder" : "a pipe or device");
  }
  ~RandomAccessFile() { ::close(file_); }
  RandomAccessFile(const RandomAccessFile&) = delete;
  RandomAccessFile& operator=(const RandomAccessFile&) = delete;
  RandomAccessFile(RandomAccessFile&&) = delete;
  RandomAccessFile& operator=(RandomAccessFile&&) = delete;

  std::size_t size() const { return static_cast<std::size_t>(status_.st_size); }
  const struct stat& status() const { return status_; }

  /// Reads up to `size` bytes from `from` on. @returns how many there were
  std::size_t read(char* to, std::size_t size, std::size_t from) const {
    std::size_t done = 0;
    while (done < size) {
      const ssize_t count = ::pread(file_, to + done, size - done, static_cast<off_t>(from + done));
      if (count < 0 && errno == EINTR) continue;
      if (count < 0) fail(std::generic_category().message(errno));
      if (count == 0) break;
      done += static_cast<std::size_t>(count);
    }
    return done;
  }
  std::string read(std::size_t size, std::size_t from) const {
    std::string text(size, '\0');
    text.resize(read(text.data(), size, from));
    return text;
  }

 private:
  [[noreturn]] void fail(const std::string& found) const {
    throw ConfigError(path_, "file", "a readable file", found);
  }

  const std::string path_;
  int file_ = -1;
  struct stat status_ {};
};

std::int64_t changed_at(const struct stat& status) {
  constexpr std::int64_t kNanoseconds = 1'000'000'000;
  return status.st_ctim.tv_sec * kNanoseconds + status.st_ctim.tv_nsec;
}

/// Hash of both ends of the first `covered` bytes.
std::uint64_t seams_of(const RandomAccessFile& store, std::size_t covered) {
  const std::size_t size = std::min(kSeam, covered);
  return Fnv1a().add(store.read(size, 0)).add(store.read(size, covered - size)).value();
}

void check_bytes(const std::string& store, std::size_t bytes) {
  if (bytes <= kMaxStoreBytes) return;
  throw ConfigError(store, "file", fmt::format("at most {}", size_in_words(kMaxStoreBytes)),
                    size_in_words(bytes));
}

}  // namespace

/// What an index says of its store, in front of the places.
struct RunIndex::Header {
  std::array<char, 24> magic = kMagic;
  std::uint64_t byte_order = 0x0102030405060708;  ///< of this machine: on another the index is made anew
  std::uint64_t covered = 0, rows = 0, places = 0;
  std::uint64_t inode = 0;
  std::int64_t changed = 0;  ///< the store, ns
  std::uint64_t seams = 0, checksum = 0;

  std::uint64_t checksum_of(std::string_view places_bytes) const {
    Header plain = *this;
    plain.checksum = 0;
    std::array<char, sizeof(Header)> bytes{};
    std::memcpy(bytes.data(), &plain, sizeof(Header));
    return Fnv1a().add({bytes.data(), bytes.size()}).add(places_bytes).value();
  }
};

RunIndex::RunIndex(std::string store, Begin begin) : store_(std::move(store)) {
  is_stale_ = begin == Begin::kAnew || !load();
  scan();
}

bool RunIndex::load() {
  const std::string path = store_ + ".index";
  struct stat status {};
  if (::stat(path.c_str(), &status) != 0 || !S_ISREG(status.st_mode)) return false;
  const RandomAccessFile file(path), store(store_);
  Header header;
  if (file.read(reinterpret_cast<char*>(&header), sizeof(Header), 0) != sizeof(Header)) return false;
  const Header expected;
  if (header.magic != expected.magic || header.byte_order != expected.byte_order ||
      header.places > kMaxStoredRuns || file.size() != sizeof(Header) + header.places * sizeof(Place))
    return false;
  const bool is_as_it_was = store.size() == header.covered && store.status().st_ino == header.inode &&
                            changed_at(store.status()) == header.changed;
  if (!is_as_it_was && store.size() <= header.covered) return false;
  std::vector<Place> places(header.places);
  const std::size_t size = places.size() * sizeof(Place);
  if (file.read(reinterpret_cast<char*>(places.data()), size, sizeof(Header)) != size) return false;
  if (header.checksum_of({reinterpret_cast<const char*>(places.data()), size}) != header.checksum ||
      seams_of(store, header.covered) != header.seams)
    return false;
  places_ = std::move(places);
  covered_ = saved_ = header.covered;
  rows_ = header.rows;
  size_ = static_cast<std::size_t>(
      std::count_if(places_.begin(), places_.end(), [](const Place& place) { return place.failed == 0; }));
  return true;
}

void RunIndex::scan() {
  const RandomAccessFile store(store_);
  check_bytes(store_, store.size());
  // A row, its end, and one byte more fit.
  std::string buffer(2 * kRunBudget.bytes + 2, '\0');
  std::size_t filled = 0;
  bytes_ = covered_;
  while (true) {
    const std::size_t count = store.read(buffer.data() + filled, buffer.size() - filled, bytes_);
    filled += count;
    bytes_ += count;
    check_bytes(store_, bytes_);
    std::string_view rest(buffer.data(), filled);
    for (std::size_t end = 0; (end = rest.find('\n')) != std::string_view::npos;
         rest.remove_prefix(end + 1)) {
      add_line(rest.substr(0, end), covered_);
      covered_ += end + 1;
    }
    if (rest.size() > kRunBudget.bytes) add_line(rest, covered_);  // which says so
    if (count == 0) {
      if (!rest.empty() && is_torn_row(rest, rows_ > 0)) {
        torn_bytes_ = rest.size();
      } else if (!rest.empty()) {
        lacks_line_end_ = true;
        add_line(rest, covered_);
      }
      break;
    }
    // The two may overlap.
    filled = static_cast<std::size_t>(std::copy(rest.begin(), rest.end(), buffer.begin()) - buffer.begin());
  }
  next_ = lacks_line_end_ ? bytes_ + 1 : covered_;
  merge();
}

void RunIndex::add_line(std::string_view line, std::size_t begin) {
  const std::size_t number = rows_ + 1;
  if (line.size() > kRunBudget.bytes) {
    throw ConfigError(store_, fmt::format("line {}", number),
                      fmt::format("at most {}", size_in_words(kRunBudget.bytes)), "more");
  }
  const StoredRow row = read_stored_row(line, store_, number);
  if (rows_ >= kMaxStoredRuns)
    throw ConfigError(store_, "file", fmt::format("at most {} rows", kMaxStoredRuns), "more");
  rows_ = number;
  Place place;
  place.hash = row.hash;
  place.begin = begin;
  place.failed = row.result ? 0 : 1;
  put(place);
}

void RunIndex::put(const Place& place) {
  const Place* const before = place_of(place.hash);
  // A run that was made is made, whatever failed later.
  if (before != nullptr && before->failed == 0 && place.failed == 1) return;
  if (place.failed == 0 && (before == nullptr || before->failed == 1)) ++size_;
  latest_.insert_or_assign(place.hash, place);
}

void RunIndex::merge() {
  const auto by_hash = [](const Place& a, const Place& b) { return a.hash < b.hash; };
  std::vector<Place> latest;
  latest.reserve(latest_.size());
  for (const auto& [hash, place] : latest_) latest.push_back(place);
  latest_ = {};
  std::sort(latest.begin(), latest.end(), by_hash);
  std::vector<Place> all;
  all.reserve(places_.size() + latest.size());
  // Of equal ones set_union takes the first range's.
  std::set_union(latest.begin(), latest.end(), places_.begin(), places_.end(), std::back_inserter(all),
                 by_hash);
  places_ = std::move(all);
}

const RunIndex::Place* RunIndex::place_of(std::uint64_t hash) const {
  if (const auto latest = latest_.find(hash); latest != latest_.end()) return &latest->second;
  const auto place = std::lower_bound(places_.begin(), places_.end(), hash,
                                      [](const Place& a, std::uint64_t wanted) { return a.hash < wanted; });
  return place != places_.end() && place->hash == hash ? &*place : nullptr;
}

std::optional<RunResult> RunIndex::find(std::uint64_t hash) const {
  const Place* const place = place_of(hash);
  if (place == nullptr || place->failed == 1) return std::nullopt;
  const RandomAccessFile store(store_);
  constexpr std::size_t kUsual = 8192;
  std::string line = store.read(kUsual, place->begin);
  if (line.find('\n') == std::string::npos) line = store.read(kRunBudget.bytes + 1, place->begin);
  line.resize(std::min(line.find('\n'), line.size()));
  const std::string where = fmt::format("byte {}", place->begin);
  StoredRow row = read_stored_row(line, store_, 1);
  if (row.hash != hash || !row.result)
    throw ConfigError(store_, where, fmt::format("the run {:016x}", hash), "another: the file was changed");
  return std::move(row.result);
}

void RunIndex::add(std::uint64_t hash, std::size_t begin, std::size_t end, bool failed) {
  Place place;
  place.hash = hash;
  place.begin = begin;
  place.failed = failed ? 1 : 0;
  put(place);
  ++rows_;
  knows_all_ = knows_all_ && begin == next_;
  covered_ = next_ = end;
  lacks_line_end_ = false;
}

std::optional<bool> RunIndex::has_failed(std::uint64_t hash) const {
  const Place* const place = place_of(hash);
  return place == nullptr ? std::nullopt : std::optional(place->failed == 1);
}

void RunIndex::save(std::size_t least_bytes) noexcept try {
  constexpr std::size_t kWorthIt = 16;  // a sixteenth of the store is new
  if (!knows_all_ || lacks_line_end_ || covered_ < least_bytes) return;
  if (!is_stale_ && covered_ - saved_ < covered_ / kWorthIt) return;
  const std::string path = store_ + ".index";
  if (struct stat there{}; ::lstat(path.c_str(), &there) == 0) {
    if (!S_ISREG(there.st_mode)) return;
    if (RandomAccessFile(path).read(kMagic.size(), 0) != std::string_view(kMagic.data(), kMagic.size()))
      return;
  }
  merge();
  const RandomAccessFile store(store_);
  Header header;
  header.covered = covered_;
  header.rows = rows_;
  header.places = places_.size();
  header.inode = store.status().st_ino;
  header.changed = changed_at(store.status());
  header.seams = seams_of(store, covered_);
  const std::string_view bytes(reinterpret_cast<const char*>(places_.data()), places_.size() * sizeof(Place));
  header.checksum = header.checksum_of(bytes);
  AtomicFile file(path);
  file.write({reinterpret_cast<const char*>(&header), sizeof(Header)});
  file.write(bytes);
  file.commit();
  saved_ = covered_;
  is_stale_ = false;
} catch (...) {
  // The next who opens the store reads it instead.
}

}  // namespace crossgait
