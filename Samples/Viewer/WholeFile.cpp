#include <Fulcrum/Samples/Viewer/WholeFile.h>

#include <cerrno>
#include <cstring>
#include <fstream>

namespace fulcrum {
namespace {

Error Failure(const std::filesystem::path& path, const std::string& reason) {
    return {ErrorCode::OutOfRange, "cannot write " + path.string() + ": " + reason};
}

bool WriteParts(const std::filesystem::path& path, std::initializer_list<std::string_view> parts) {
    std::ofstream file(path, std::ios::binary | std::ios::trunc);
    for (std::string_view part : parts) file.write(part.data(), static_cast<std::streamsize>(part.size()));
    file.close();
    return file.good();
}

}  // namespace

Status WriteWholeFile(const std::filesystem::path& path, std::initializer_list<std::string_view> parts) {
    std::error_code error;
    if (path.has_parent_path()) std::filesystem::create_directories(path.parent_path(), error);
    if (error) return Failure(path, error.message());

    std::filesystem::path part = path;
    part += ".part";
    errno = 0;
    if (!WriteParts(part, parts)) {
        const std::string reason = errno != 0 ? std::strerror(errno) : "the system gives no reason";
        std::filesystem::remove(part, error);
        return Failure(path, reason);
    }
    std::filesystem::rename(part, path, error);
    if (!error) return Done{};
    const std::string reason = error.message();
    std::filesystem::remove(part, error);
    return Failure(path, reason);
}

}  // namespace fulcrum
