#include <Fulcrum/Physics/Files/WholeFile.h>

#include <Fulcrum/Physics/Files/ErrorBoundary.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <random>

namespace fulcrum {

namespace fs = std::filesystem;

namespace {

Error CannotRead(ErrorCode code, const fs::path& file, const std::string& why) {
    return {code, file.string() + ": " + why};
}
Error CannotWrite(const fs::path& file, const std::string& why) {
    return {ErrorCode::OutOfRange, "cannot write " + file.string() + ": " + why};
}

std::string ReasonOf(int number) {
    return number != 0 ? std::generic_category().message(number) : "the system gives no reason";
}

std::string TooLarge(uint64_t most) { return "it has more than the " + std::to_string(most) + " bytes that are read"; }

Result<std::string> ReadRegularFile(const fs::path& file, uint64_t most) {
    std::error_code error;
    const fs::file_status status = fs::status(file, error);
    const auto unsupported = [&](const std::string& why) { return CannotRead(ErrorCode::Unsupported, file, why); };
    if (fs::is_directory(status)) return unsupported("it cannot be read: it is a folder");
    if (fs::exists(status) && !fs::is_regular_file(status))
        return unsupported("it cannot be read: it is a device or a pipe, which may have no end");
    const std::unique_ptr<std::FILE, int (*)(std::FILE*)> stream(std::fopen(file.c_str(), "rb"), std::fclose);
    if (!stream) return unsupported("it cannot be opened" + (errno == ENOENT ? "" : ": " + ReasonOf(errno)));
    const uint64_t size = fs::file_size(file, error);
    if (!error && size > most) return CannotRead(ErrorCode::OutOfRange, file, TooLarge(most));

    // The size is a hint: files of /proc say 0, and others may grow.
    std::string bytes(error ? 0 : static_cast<size_t>(size), '\0');
    size_t count = std::fread(bytes.data(), 1, bytes.size(), stream.get());
    if (count == bytes.size()) {
        char more[4096];
        for (size_t got; (got = std::fread(more, 1, sizeof more, stream.get())) > 0; count += got) {
            if (count + got > most) return CannotRead(ErrorCode::OutOfRange, file, TooLarge(most));
            bytes.append(more, got);
        }
    }
    if (std::ferror(stream.get())) return unsupported("it cannot be read: " + ReasonOf(errno));
    bytes.resize(count);
    return bytes;
}

// A name in the same folder that no file has: short, since the file's own may be as long as names can be.
fs::path NameBeside(const fs::path& file) {
    std::random_device random;
    char name[40];
    std::snprintf(name, sizeof name, ".fulcrum-%08x%08x.part", random(), random());
    return file.parent_path() / name;
}

// Follows links, also to what does not exist yet.
fs::path TargetOf(fs::path file) {
    constexpr int kMostLinks = 40;  // as of Linux
    std::error_code error;
    for (int i = 0; i < kMostLinks && fs::is_symlink(fs::symlink_status(file, error)); ++i) {
        const fs::path next = fs::read_symlink(file, error);
        if (error) break;
        file = file.parent_path() / next;
    }
    return file;
}

}  // namespace

Result<std::string> ReadWholeFile(const fs::path& file, uint64_t most) {
    return WithErrors(file.string(), [&] { return ReadRegularFile(file, most); });
}

FileReplacement::FileReplacement(fs::path name, fs::path target) : name_(std::move(name)), target_(std::move(target)) {}

FileReplacement::FileReplacement(FileReplacement&& other) noexcept
    : name_(std::move(other.name_)),
      target_(std::move(other.target_)),
      part_(std::exchange(other.part_, fs::path())),
      stream_(std::move(other.stream_)) {}

FileReplacement::~FileReplacement() {
    stream_.reset();
    std::error_code ignored;
    if (!part_.empty()) fs::remove(part_, ignored);
}

Error FileReplacement::Failure(int reason) const { return CannotWrite(name_, ReasonOf(reason)); }

Result<FileReplacement> FileReplacement::Open(const fs::path& file) {
    std::error_code error;
    FileReplacement opened(file, TargetOf(file));
    const fs::path folder = opened.target_.parent_path();
    if (file.empty()) return CannotWrite(file, "it has no name");
    if (!folder.empty() && !fs::is_directory(folder, error))
        return CannotWrite(file, "there is no folder " + folder.string());
    const fs::file_status status = fs::status(opened.target_, error);
    if (fs::is_directory(status)) return CannotWrite(file, "it is a folder");
    const bool isThere = fs::exists(status), isRegular = !isThere || fs::is_regular_file(status);
    if (isThere) {
        // What must not be written must not be replaced either.
        opened.stream_.reset(std::fopen(opened.target_.c_str(), isRegular ? "r+b" : "wb"));
        if (!opened.stream_) return opened.Failure(errno);
    }
    if (!isRegular) return opened;
    opened.part_ = NameBeside(opened.target_);
    opened.stream_.reset(std::fopen(opened.part_.c_str(), "wbx"));
    if (!opened.stream_) {
        const int reason = errno;
        opened.part_.clear();
        return opened.Failure(reason);
    }
    if (isThere) fs::permissions(opened.part_, status.permissions(), error);
    return opened;
}

Status FileReplacement::Write(std::string_view bytes) {
    errno = 0;
    if (std::fwrite(bytes.data(), 1, bytes.size(), stream_.get()) != bytes.size()) return Failure(errno);
    return Done{};
}

Status FileReplacement::Flush() {
    errno = 0;
    if (std::fflush(stream_.get()) != 0) return Failure(errno);
    return Done{};
}

Status FileReplacement::PutInPlace() {
    if (part_.empty()) return Done{};
    std::error_code error;
    fs::rename(part_, target_, error);
    if (error) return CannotWrite(name_, error.message());
    part_.clear();
    return Done{};
}

Status FileReplacement::Replace() {
    if (Status flushed = Flush(); !flushed) return flushed;
    return PutInPlace();
}

Status FileReplacement::Finish() {
    if (Status flushed = Flush(); !flushed) return flushed;
    errno = 0;
    if (std::fclose(stream_.release()) != 0) return Failure(errno);
    return PutInPlace();
}

Status WriteWholeFile(const fs::path& file, std::initializer_list<std::string_view> parts, MissingFolders folders) {
    return WithErrors("cannot write " + file.string(), [&]() -> Status {
        std::error_code error;
        if (folders == MissingFolders::AreCreated && file.has_parent_path())
            fs::create_directories(file.parent_path(), error);
        if (error) return CannotWrite(file, error.message());
        Result<FileReplacement> replacement = FileReplacement::Open(file);
        if (!replacement) return replacement.GetError();
        for (const std::string_view part : parts)
            if (Status written = replacement.Value().Write(part); !written) return written;
        return replacement.Value().Finish();
    });
}

Status CheckWritable(const fs::path& file) {
    return WithErrors("cannot write " + file.string(), [&]() -> Status {
        std::error_code error;
        const fs::file_status status = fs::status(file, error);
        // To open a pipe would wait for its reader, and end what it reads.
        if (fs::exists(status) && !fs::is_regular_file(status) && !fs::is_directory(status)) return Done{};
        const Result<FileReplacement> replacement = FileReplacement::Open(file);
        if (!replacement) return replacement.GetError();
        return Done{};
    });
}

}  // namespace fulcrum
