#include <Fulcrum/Samples/Viewer/HtmlWriter.h>

#include <Fulcrum/Assets/Json/Base64.h>
#include <Fulcrum/Samples/Viewer/PageData.h>
#include <Fulcrum/Samples/Viewer/WholeFile.h>

#include <fstream>
#include <sstream>

namespace fulcrum {
namespace {

// Where the page's bundle has the recording; build.mjs puts it there.
constexpr std::string_view kPlaceOfRecording = "@@FULCRUM_RECORDING@@";

std::string ReadFile(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    std::ostringstream content;
    content << file.rdbuf();
    return content.str();
}

}  // namespace

Status WriteHtml(const Recording& recording, const std::filesystem::path& path) {
    if (Status valid = CheckRecording(recording); !valid) return valid;
    const std::string page = ReadFile(FULCRUM_VIEWER_PAGE);
    const size_t place = page.find(kPlaceOfRecording);
    if (place == std::string::npos)
        return Error{ErrorCode::OutOfRange, "the page's bundle " FULCRUM_VIEWER_PAGE
                                            " is missing or damaged: build the target FulcrumViewerPage"};
    const std::string data = ToBase64(Deflated(EncodePageData(recording)));
    const std::string_view whole = page;
    return WriteWholeFile(path, {whole.substr(0, place), data, whole.substr(place + kPlaceOfRecording.size())});
}

}  // namespace fulcrum
