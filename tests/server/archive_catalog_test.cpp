#include "server/archive_catalog.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "server/pages.h"
#include "tests/server/synthetic_city.h"

namespace citystream::server {
namespace {

std::string error_of(const std::vector<std::string>& files) {
    const auto catalog = ArchiveCatalog::open(files);
    return catalog.ok() ? std::string() : catalog.error().text();
}

TEST(UrlName, IsTheStemWithSafeCharactersOnly) {
    EXPECT_EQ(url_name_of("/data/tokyo.3tz"), "tokyo");
    EXPECT_EQ(url_name_of("old town & harbour.3tz"), "old-town---harbour");
    EXPECT_EQ(url_name_of("a.b_c-d.3tz"), "a.b_c-d");
    EXPECT_EQ(url_name_of("..hidden.3tz"), "hidden");
    EXPECT_EQ(url_name_of("...3tz"), "city");
}

TEST(ArchiveCatalog, GivesTwoFilesOfOneNameTwoNames) {
    const test::TemporaryFolder folder;
    std::filesystem::create_directories(folder.path() / "b");
    std::filesystem::create_directories(folder.path() / "c");
    for (const char* name : {"demo.3tz", "b/demo.3tz", "c/demo.3tz", "metrics.3tz"}) test::write_city(folder / name);
    const auto catalog = ArchiveCatalog::open(
        {folder / "demo.3tz", folder / "b/demo.3tz", folder / "c/demo.3tz", folder / "metrics.3tz"});
    ASSERT_TRUE(catalog.ok()) << catalog.error().text();
    EXPECT_EQ(catalog->cities()[0].name, "demo");
    EXPECT_EQ(catalog->cities()[1].name, "demo-2");
    EXPECT_EQ(catalog->cities()[2].name, "demo-3");
    EXPECT_EQ(catalog->cities()[3].name, "metrics-2") << "a city may not hide /metrics";
    EXPECT_EQ(catalog->remarks().size(), 3u);
    EXPECT_EQ(catalog->find("demo-3"), 2u);
    EXPECT_FALSE(catalog->find("demo-4"));
}

TEST(ArchiveCatalog, NamesTheFileThatCannotBeServed) {
    const test::TemporaryFolder folder;
    EXPECT_EQ(error_of({folder / "nowhere.3tz"}), folder / "nowhere.3tz" + ": no such file");
    EXPECT_NE(error_of({folder.path().string()}).find("a folder"), std::string::npos);
    std::ofstream(folder / "text.3tz") << "this is no archive";
    EXPECT_EQ(error_of({folder / "text.3tz"}).rfind(folder / "text.3tz" + ": ", 0), 0u);
    std::ofstream(folder / "empty.3tz").flush();
    EXPECT_NE(error_of({folder / "empty.3tz"}), "");
}

TEST(ArchiveCatalog, RefusesAnArchiveWithoutReadableDirectory) {
    const test::TemporaryFolder folder;
    for (const bool broken : {false, true}) {
        auto writer = tiles::archive::ArchiveWriter::create(folder / "x.3tz");
        ASSERT_TRUE(writer.ok());
        ASSERT_TRUE((*writer)->add(broken ? "tileset.json" : "other.json", test::bytes_of("{}")).ok());
        ASSERT_TRUE((*writer)->finish().ok());
        EXPECT_NE(error_of({folder / "x.3tz"}).find("tileset.json"), std::string::npos);
    }
}

TEST(ArchiveCatalog, TagsAnEntryByItsChecksumAndSize) {
    const test::TemporaryFolder folder;
    test::write_city(folder / "demo.3tz");
    const auto catalog = ArchiveCatalog::open({folder / "demo.3tz"});
    ASSERT_TRUE(catalog.ok());
    const City& city = catalog->cities()[0];
    for (const auto& entry : city.archive->entries()) {
        const auto found = city.find(entry.name);
        ASSERT_TRUE(found) << entry.name;
        char expected[64];
        std::snprintf(expected, sizeof expected, "\"%08x-%llx\"", entry.crc32,
                      static_cast<unsigned long long>(entry.size));
        EXPECT_EQ(found->etag, expected) << entry.name;
    }
    EXPECT_FALSE(city.find("tiles/0/0/0.atlas"));
}

TEST(Pages, TellEachCityWithPictureAndSizes) {
    const test::TemporaryFolder folder;
    test::write_city(folder / "demo.3tz", "Old <Town> & \"Harbour\"");
    const auto catalog = ArchiveCatalog::open({folder / "demo.3tz"});
    ASSERT_TRUE(catalog.ok());
    const std::string page = index_page(catalog->cities());
    EXPECT_NE(page.find("Old &lt;Town&gt; &amp; &quot;Harbour&quot;"), std::string::npos)
        << "a title is text, not markup";
    EXPECT_EQ(page.find("<Town>"), std::string::npos);
    EXPECT_NE(page.find("src=\"demo/preview.png\""), std::string::npos);
    EXPECT_NE(page.find("1.00 kB"), std::string::npos);
    EXPECT_NE(page.find("EPSG:25832"), std::string::npos);
    EXPECT_EQ(page.find("<script"), std::string::npos);
    EXPECT_EQ(page.find("http"), std::string::npos) << "nothing may be loaded from elsewhere";
    EXPECT_NE(city_page(catalog->cities()[0]).find("href=\"tileset.json\""), std::string::npos);
}

TEST(Pages, ListTheCitiesForPrograms) {
    const test::TemporaryFolder folder;
    test::write_city(folder / "demo.3tz", "Town");
    const auto catalog = ArchiveCatalog::open({folder / "demo.3tz"});
    ASSERT_TRUE(catalog.ok());
    const auto document = nlohmann::json::parse(cities_json(catalog->cities()));
    const auto& city = document.at("cities").at(0);
    EXPECT_EQ(city.at("name"), "demo");
    EXPECT_EQ(city.at("title"), "Town");
    EXPECT_EQ(city.at("tileset"), "/demo/tileset.json");
    EXPECT_EQ(city.at("preview"), "/demo/preview.png");
    EXPECT_EQ(city.at("buildings"), 1234);
    EXPECT_EQ(city.at("epsg"), 25832);
    EXPECT_EQ(city.at("extent"), (std::vector<double>{677889, 5402882, 360, 677989, 5403002, 401.5}));
    EXPECT_EQ(city.at("layers").size(), 1u);
    EXPECT_EQ(city.at("layers").at("mesh").at("wire_bytes"), 1000);
}

TEST(HumanBytes, KeepsThreeDigits) {
    EXPECT_EQ(human_bytes(0), "0 B");
    EXPECT_EQ(human_bytes(999), "999 B");
    EXPECT_EQ(human_bytes(1000), "1.00 kB");
    EXPECT_EQ(human_bytes(12'345'678), "12.3 MB");
    EXPECT_EQ(human_bytes(999'900), "1.00 MB");
    EXPECT_EQ(human_bytes(123'456'789'012), "123 GB");
}

}  // namespace
}  // namespace citystream::server
