// An archive that notes the names of one structure's own fields (Physics/SettingsFields.h). One thread at a time.
#pragma once

#include <set>
#include <string>

namespace fulcrum::testing {

class FieldNames {
public:
    template <class T>
    void Field(const char* name, T&) {
        names.insert(name);
    }
    template <class E, class Names>
    void Choice(const char* name, E&, const Names&) {
        names.insert(name);
    }
    std::set<std::string> names;
};

}  // namespace fulcrum::testing
