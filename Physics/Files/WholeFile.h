// Whole files: reads one within a limit, and replaces one whole or not at all. All files of the library and its
// programs are read and written here. Any thread, also several that write the same file: the last one remains.
#pragma once

#include <Fulcrum/Math/Result.h>

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <initializer_list>
#include <memory>
#include <span>
#include <string>
#include <string_view>

namespace fulcrum {

// The largest files that are read, in bytes. Documents become trees of 16 bytes and more for each of their values,
// which are counted (Assets/Json/JsonLimits.h): this bounds their texts. Recordings are kept as they are, and are of
// hours.
inline constexpr uint64_t kMostDocumentBytes = uint64_t{1} << 28, kMostRecordingBytes = uint64_t{1} << 32;

// All bytes of a regular file, or of what links to one. Errors, which begin with the file's name: Unsupported (it does
// not exist, is a folder, a device or a pipe, which may have no end, or cannot be read), OutOfRange (it has more than
// `most` bytes, or memory is short).
Result<std::string> ReadWholeFile(const std::filesystem::path& file, uint64_t most = kMostDocumentBytes);

// A file that is written beside the one of its name, and then takes its place: until then, and if anything fails, what
// was there remains as it was. Links are followed and permissions kept. Devices and pipes are written directly.
class FileReplacement {
public:
    // Errors, which begin with "cannot write" and the file's name and have the system's reason: OutOfRange (its folder
    // does not exist, it is a folder itself, it or its folder must not be written).
    static Result<FileReplacement> Open(const std::filesystem::path& file);
    FileReplacement(FileReplacement&& other) noexcept;
    ~FileReplacement();  // removes what has not taken its place

    // Errors: likewise, such as a full disk.
    Status Write(std::string_view bytes);
    // Hands over to the system what was written.
    Status Flush();
    // Flushes, and takes the place of the file. More may be written, which is then in the file at once.
    Status Replace();
    // The same, at the end.
    Status Finish();

private:
    struct Closer {
        void operator()(std::FILE* stream) const { std::fclose(stream); }
    };
    FileReplacement(std::filesystem::path name, std::filesystem::path target);
    Error Failure(int reason) const;
    Status PutInPlace();

    std::filesystem::path name_, target_;  // as it was asked for, without links
    std::filesystem::path part_;           // where it is written; empty: at the target
    std::unique_ptr<std::FILE, Closer> stream_;
};

enum class MissingFolders { AreErrors, AreCreated };

// Replaces or creates a file with the concatenated parts. Errors: those of FileReplacement.
Status WriteWholeFile(const std::filesystem::path& file, std::initializer_list<std::string_view> parts,
                      MissingFolders folders = MissingFolders::AreErrors);

// Whether a file can be written, for programs that compute for long before they do so; a disk may be full by then.
// Changes nothing. Errors: those of FileReplacement::Open.
Status CheckWritable(const std::filesystem::path& file);

}  // namespace fulcrum
