#include <Fulcrum/Samples/Viewer/HtmlWriter.h>

#include <Fulcrum/Assets/Json/Base64.h>
#include <Fulcrum/Physics/Files/WholeFile.h>
#include <Fulcrum/Samples/Viewer/PageData.h>

namespace fulcrum {
namespace {

// Where the page's bundle has the recording; build.mjs puts it there.
constexpr std::string_view kPlaceOfRecording = "@@FULCRUM_RECORDING@@";

}  // namespace

Status WriteHtml(const Recording& recording, const std::filesystem::path& path) {
    if (Status valid = CheckRecording(recording); !valid) return valid;
    const Result<std::string> page = ReadWholeFile(FULCRUM_VIEWER_PAGE);
    const std::string_view whole = page ? std::string_view(page.Value()) : std::string_view();
    const size_t place = whole.find(kPlaceOfRecording);
    if (place == std::string::npos)
        return Error{ErrorCode::OutOfRange, "the page's bundle " FULCRUM_VIEWER_PAGE
                                            " is missing or damaged: build the target FulcrumViewerPage"};
    const std::string data = ToBase64(Deflated(EncodePageData(recording)));
    return WriteWholeFile(path, {whole.substr(0, place), data, whole.substr(place + kPlaceOfRecording.size())},
                          MissingFolders::AreCreated);
}

}  // namespace fulcrum
