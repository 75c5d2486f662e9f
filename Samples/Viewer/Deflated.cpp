#include <Fulcrum/Samples/Viewer/PageData.h>

#include <zlib.h>

#include <new>

namespace fulcrum {

std::string Deflated(const std::string& bytes) {
    uLongf size = compressBound(bytes.size());
    std::string packed(size, '\0');
    // Fails only if memory is exhausted; compressBound guarantees that `packed` is large enough.
    if (compress2(reinterpret_cast<Bytef*>(packed.data()), &size, reinterpret_cast<const Bytef*>(bytes.data()),
                  bytes.size(), Z_DEFAULT_COMPRESSION) != Z_OK)
        throw std::bad_alloc();
    packed.resize(size);
    return packed;
}

}  // namespace fulcrum
