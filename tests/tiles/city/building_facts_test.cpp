// What inputs say of a building's storeys and use.
#include "tiles/city/building_facts.h"

#include <gtest/gtest.h>

#include "tests/tiles/city/city_probe.h"
#include "tests/tiles/city/gml_text.h"

namespace citystream::tiles::city {
namespace {

BuildingFacts facts_of(const std::string& name, const std::string& text) {
    BuildingFacts facts;
    note_building_fact(facts, name, text);
    return facts;
}

TEST(BuildingFacts, StoreysAreWholeNumbersThatABuildingCanHave) {
    EXPECT_EQ(facts_of("storeysAboveGround", "7").storeys, 7);
    EXPECT_EQ(facts_of("storeysAboveGround", " 12\n").storeys, 12);
    for (const char* text : {"", "0", "-3", "201", "99999999999", "many"})
        EXPECT_EQ(facts_of("storeysAboveGround", text).storeys, 0) << text;
}

TEST(BuildingFacts, UsesAreKnownByNameAndByCode) {
    const std::vector<std::pair<const char*, BuildingUse>> known = {{"Detached house", BuildingUse::kHouse},
                                                                    {"apartment house", BuildingUse::kApartments},
                                                                    {"OFFICE BUILDING", BuildingUse::kOffice},
                                                                    {"Lagerhalle", BuildingUse::kHall},
                                                                    {"commercial", BuildingUse::kShop},
                                                                    {"garage", BuildingUse::kGarage},
                                                                    {"Wohngebäude", BuildingUse::kResidential},
                                                                    {"411", BuildingUse::kHouse},
                                                                    {"431", BuildingUse::kHall},
                                                                    {"31001_2463", BuildingUse::kGarage},
                                                                    {"4110", BuildingUse::kUnknown},
                                                                    {"", BuildingUse::kUnknown},
                                                                    {"something else", BuildingUse::kUnknown}};
    for (const auto& [text, use] : known) EXPECT_EQ(facts_of("usage", text).use, use) << text;
}

TEST(BuildingFacts, TheFirstKnownUseStaysAndPartsInheritWhatTheyDoNotSay) {
    BuildingFacts whole = facts_of("class", "unclear");
    note_building_fact(whole, "function", "office");
    note_building_fact(whole, "usage", "garage");
    EXPECT_EQ(whole.use, BuildingUse::kOffice);
    BuildingFacts part = facts_of("storeysAboveGround", "3");
    whole.storeys = 9;
    part.inherit(whole);
    EXPECT_EQ(part, (BuildingFacts{3, BuildingUse::kOffice}));
}

TEST(BuildingFacts, AreReadFromTheAttributesOfCityJson) {
    const std::string shape = R"("geometry":[{"type":"MultiSurface","lod":"1","boundaries":[[[0,1,2]]]}]})";
    const ReadCity city = read_text(
        R"({"type":"CityJSON","version":"2.0","transform":{"scale":[1,1,1],"translate":[0,0,0]},"CityObjects":{)"
        R"("a":{"type":"Building","attributes":{"storeysAboveGround":5,"function":["office"],"name":"x"},"children":["p"],)" +
        shape + R"(,"p":{"type":"BuildingPart","parents":["a"],"attributes":{"storeysAboveGround":2.0,"usage":412},)" +
        shape + R"(,"q":{"type":"BuildingPart","parents":["a"],)" + shape +
        R"(},"vertices":[[0,0,0],[4,0,0],[4,0,4]]})");
    ASSERT_TRUE(city.status.ok()) << city.status.error().text();
    ASSERT_EQ(city.objects.size(), 3U);
    EXPECT_EQ(city.objects[0].facts, (BuildingFacts{5, BuildingUse::kOffice}));
    EXPECT_EQ(city.objects[1].facts, (BuildingFacts{2, BuildingUse::kApartments}));
    EXPECT_EQ(city.objects[2].facts, (BuildingFacts{5, BuildingUse::kOffice})) << "of the building it is a part of";
}

TEST(BuildingFacts, AreReadFromThePropertiesOfCityGmlButNotFromThoseOfItsInstallations) {
    const std::string members = gml_surface_member(gml_polygon("0 0 0 4 0 0 4 0 4 0 0 0"));
    const ReadCity city = read_text(gml_model(
        gml_building("<bldg:function>31001_2143</bldg:function><bldg:storeysAboveGround>2</bldg:storeysAboveGround>"
                     "<bldg:outerBuildingInstallation><bldg:BuildingInstallation><bldg:usage>garage</bldg:usage>"
                     "</bldg:BuildingInstallation></bldg:outerBuildingInstallation>"
                     "<bldg:lod1MultiSurface><gml:MultiSurface>" +
                     members + "</gml:MultiSurface></bldg:lod1MultiSurface>")));
    ASSERT_EQ(city.objects.size(), 1U);
    EXPECT_EQ(city.objects[0].facts, (BuildingFacts{2, BuildingUse::kHall}));
}

}  // namespace
}  // namespace citystream::tiles::city
