#include <Fulcrum/Physics/Recording/CallRecording.h>

#include <Fulcrum/Physics/Files/ErrorBoundary.h>
#include <Fulcrum/Physics/Files/WholeFile.h>
#include <Fulcrum/Physics/Recording/CallTable.h>
#include <Fulcrum/Physics/Recording/RecordingFormat.h>

#include <algorithm>
#include <string>

namespace fulcrum {

struct CallRecording::Parser {
    CallRecording& recording;
    std::vector<uint16_t> rows;  // of the recording's functions

    MaybeError Run() {
        const std::vector<std::byte>& bytes = recording.bytes_;
        const size_t headSize = kRecordingMagic.size() + sizeof kRecordingVersion;
        if (bytes.size() < headSize || std::memcmp(bytes.data(), kRecordingMagic.data(), kRecordingMagic.size()) != 0)
            return Error{ErrorCode::Unsupported, "it is no recording of calls"};
        uint32_t version = 0;
        std::memcpy(&version, bytes.data() + kRecordingMagic.size(), sizeof version);
        if (version != kRecordingVersion)
            return Error{ErrorCode::Unsupported, "the recording has version " + std::to_string(version) +
                                                     " of the format; this library reads " +
                                                     std::to_string(kRecordingVersion)};
        for (size_t at = headSize; at < bytes.size();) {
            RecordingPiece piece;
            if (bytes.size() - at < sizeof piece) break;  // the end is missing
            std::memcpy(&piece, bytes.data() + at, sizeof piece);
            if (piece.sizeHash != HashOfSize(piece.size))
                return DamagedRecording("at byte " + std::to_string(at) + " is no valid size");
            at += sizeof piece;
            if (bytes.size() - at < piece.size) break;
            if (HashBytes(bytes.data() + at, piece.size) != piece.dataHash)
                return DamagedRecording("the " + std::to_string(piece.size) + " bytes from byte " + std::to_string(at) +
                                        " on are not as they were written");
            if (MaybeError error = AddEntries(at, at + piece.size)) return error;
            at += piece.size;
        }
        return CheckOrder();
    }

private:
    template <class T>
    T Get(size_t at) const {
        T value;
        std::memcpy(&value, recording.bytes_.data() + at, sizeof value);
        return value;
    }

    MaybeError AddEntries(size_t at, size_t end) {
        while (at < end) {
            constexpr size_t kHead = sizeof(EntryKind) + sizeof(uint64_t);
            if (end - at < kHead) return DamagedRecording("an entry has no size");
            Entry entry{.kind = Get<EntryKind>(at), .begin = at + kHead};
            const uint64_t size = Get<uint64_t>(at + 1);
            if (entry.kind > EntryKind::End || size > end - entry.begin)
                return DamagedRecording("an entry has no kind or no end");
            entry.size = size;
            at = entry.begin + entry.size;
            if (MaybeError error = Check(entry)) return error;
            recording.entries_.push_back(entry);
        }
        return {};
    }

    MaybeError Check(Entry& entry) {
        if (recording.entries_.empty() != (entry.kind == EntryKind::Functions))
            return DamagedRecording("it does not begin with its functions");
        switch (entry.kind) {
            case EntryKind::Functions: return ReadFunctions(entry);
            case EntryKind::Call: return ReadCall(entry);
            case EntryKind::Shape:
                return entry.size >= sizeof(uint64_t) ? MaybeError() : DamagedRecording("a shape has no hash");
            case EntryKind::Step:
                return entry.size == sizeof(uint64_t) ? MaybeError() : DamagedRecording("a step has no hash");
            case EntryKind::Bodies:
                return entry.size % sizeof(BodyHash) == 0 ? MaybeError()
                                                          : DamagedRecording("a list of bodies has no end");
            case EntryKind::End: recording.isComplete_ = true; return {};
            default: return {};
        }
    }

    MaybeError ReadFunctions(const Entry& entry) {
        const RecordedObjects none;
        const ReplaySources noSources;
        CallReader reader(recording.DataOf(entry), none, noSources, nullptr);
        uint64_t count = 0;
        reader.Read(count);
        for (uint64_t i = 0; i < count && !reader.IsBad(); ++i) {
            std::vector<std::byte> bytes;
            uint64_t layout = 0;
            reader.Read(bytes);
            reader.Read(layout);
            const std::string name(reinterpret_cast<const char*>(bytes.data()), bytes.size());
            const auto found = std::ranges::find_if(CallRows(), [&](const CallRow& row) { return row.name == name; });
            if (reader.IsBad()) break;
            if (found == CallRows().end() || found->layout != layout)
                return Error{ErrorCode::Unsupported,
                             "the recording is of another version of the library, whose " + name +
                                 (found == CallRows().end() ? " does not exist here" : " has other arguments")};
            rows.push_back(static_cast<uint16_t>(found - CallRows().begin()));
        }
        return reader.IsBad() || !reader.IsAtEnd() ? DamagedRecording("its list of functions") : MaybeError();
    }

    MaybeError ReadCall(Entry& entry) {
        uint16_t number = 0;
        if (entry.size < sizeof number) return DamagedRecording("a call has no function");
        number = Get<uint16_t>(entry.begin);
        if (number >= rows.size()) return DamagedRecording("a call is of no function");
        entry.row = rows[number];
        entry.begin += sizeof number;
        entry.size -= sizeof number;
        ++recording.calls_;
        recording.steps_ += CallRows()[entry.row].tag == StepTag();
        return {};
    }

    // The world comes first, and once.
    MaybeError CheckOrder() const {
        size_t worlds = 0;
        for (const Entry& entry : recording.entries_) {
            worlds += entry.kind == EntryKind::Settings || entry.kind == EntryKind::Snapshot;
            if (entry.kind == EntryKind::Call && worlds != 1) return DamagedRecording("its calls are of no world");
        }
        if (worlds != 1) return DamagedRecording("it has no world");
        return {};
    }
};

Result<CallRecording> CallRecording::Read(std::vector<std::byte> bytes) {
    CallRecording recording;
    recording.bytes_ = std::move(bytes);
    Parser parser{recording, {}};
    if (MaybeError error = parser.Run()) return *error;
    return recording;
}

Result<CallRecording> CallRecording::ReadFile(const std::string& file) {
    return WithErrors(file, [&]() -> Result<CallRecording> {
        const Result<std::string> read = ReadWholeFile(file, kMostRecordingBytes);
        if (!read) return read.GetError();
        const auto* begin = reinterpret_cast<const std::byte*>(read.Value().data());
        Result<CallRecording> recording = Read({begin, begin + read.Value().size()});
        if (!recording) return Error{recording.GetError().code, file + ": " + recording.GetError().message};
        return recording;
    });
}

}  // namespace fulcrum
