#include "client/render/video_writer.h"

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
#include <libavutil/opt.h>
#include <libswscale/swscale.h>
}

namespace citystream::client {
namespace {

std::string av_text(int code) {
    char text[AV_ERROR_MAX_STRING_SIZE] = {};
    av_strerror(code, text, sizeof text);
    return text;
}

class Mp4Writer final : public VideoWriter {
  public:
    Mp4Writer(std::string path, const VideoOptions& options) : path_(std::move(path)), options_(options) {}
    Mp4Writer(const Mp4Writer&) = delete;
    Mp4Writer& operator=(const Mp4Writer&) = delete;
    ~Mp4Writer() override;

    Status open();
    Status add(const FrameImage& frame) override;
    Status finish() override;

  private:
    Status check(int code, const char* what) const {
        if (code >= 0) return Done{};
        return Error{path_ + ": " + what + ": " + av_text(code)};
    }
    Status open_encoder();
    Status open_file();
    Status encode(const AVFrame* frame);

    std::string path_;
    VideoOptions options_;
    AVFormatContext* format_ = nullptr;
    AVCodecContext* encoder_ = nullptr;
    AVStream* stream_ = nullptr;
    AVFrame* frame_ = nullptr;
    AVPacket* packet_ = nullptr;
    SwsContext* scaler_ = nullptr;
    int64_t frames_ = 0;
};

Mp4Writer::~Mp4Writer() {
    sws_freeContext(scaler_);
    av_packet_free(&packet_);
    av_frame_free(&frame_);
    avcodec_free_context(&encoder_);
    if (format_ != nullptr) avio_closep(&format_->pb);
    avformat_free_context(format_);
}

Status Mp4Writer::open_encoder() {
    const AVCodec* codec = avcodec_find_encoder_by_name("libx264");
    if (codec == nullptr) return Error{path_ + ": libavcodec has no libx264 encoder"};
    encoder_ = avcodec_alloc_context3(codec);
    const int frames_per_second = static_cast<int>(options_.frames_per_second);
    encoder_->width = static_cast<int>(options_.width & ~1u);
    encoder_->height = static_cast<int>(options_.height & ~1u);
    encoder_->pix_fmt = AV_PIX_FMT_YUV420P;
    encoder_->time_base = {1, frames_per_second};
    encoder_->framerate = {frames_per_second, 1};
    encoder_->thread_count = 1;
    encoder_->colorspace = AVCOL_SPC_BT709;
    encoder_->color_primaries = AVCOL_PRI_BT709;
    encoder_->color_trc = AVCOL_TRC_BT709;
    encoder_->color_range = AVCOL_RANGE_MPEG;
    encoder_->flags |= AV_CODEC_FLAG_GLOBAL_HEADER | AV_CODEC_FLAG_BITEXACT;
    av_opt_set(encoder_->priv_data, "preset", "veryfast", 0);
    av_opt_set_int(encoder_->priv_data, "crf", options_.quality, 0);
    return check(avcodec_open2(encoder_, codec, nullptr), "H.264 encoder");
}

Status Mp4Writer::open_file() {
    stream_ = avformat_new_stream(format_, nullptr);
    if (stream_ == nullptr) return Error{path_ + ": out of memory"};
    stream_->time_base = encoder_->time_base;
    stream_->avg_frame_rate = encoder_->framerate;
    avcodec_parameters_from_context(stream_->codecpar, encoder_);
    format_->flags |= AVFMT_FLAG_BITEXACT;
    if (Status status = check(avio_open(&format_->pb, path_.c_str(), AVIO_FLAG_WRITE), "cannot be written"); !status) {
        return status;
    }
    AVDictionary* options = nullptr;
    av_dict_set(&options, "movflags", "faststart", 0);
    const int code = avformat_write_header(format_, &options);
    av_dict_free(&options);
    return check(code, "MP4 header");
}

Status Mp4Writer::open() {
    if (Status status = check(avformat_alloc_output_context2(&format_, nullptr, "mp4", path_.c_str()), "MP4");
        !status) {
        return status;
    }
    if (Status status = open_encoder(); !status) return status;
    if (Status status = open_file(); !status) return status;
    packet_ = av_packet_alloc();
    frame_ = av_frame_alloc();
    frame_->format = encoder_->pix_fmt;
    frame_->width = encoder_->width;
    frame_->height = encoder_->height;
    if (Status status = check(av_frame_get_buffer(frame_, 0), "frame buffer"); !status) return status;
    scaler_ =
        sws_getContext(encoder_->width, encoder_->height, AV_PIX_FMT_RGBA, encoder_->width, encoder_->height,
                       AV_PIX_FMT_YUV420P, SWS_BILINEAR | SWS_ACCURATE_RND | SWS_BITEXACT, nullptr, nullptr, nullptr);
    if (scaler_ == nullptr) return Error{path_ + ": no conversion from RGBA to YUV 4:2:0"};
    const int* table = sws_getCoefficients(SWS_CS_ITU709);
    sws_setColorspaceDetails(scaler_, table, 1, table, 0, 0, 1 << 16, 1 << 16);
    return Done{};
}

Status Mp4Writer::encode(const AVFrame* frame) {
    if (Status status = check(avcodec_send_frame(encoder_, frame), "encoding"); !status) return status;
    while (true) {
        const int code = avcodec_receive_packet(encoder_, packet_);
        if (code == AVERROR(EAGAIN) || code == AVERROR_EOF) return Done{};
        if (Status status = check(code, "encoding"); !status) return status;
        packet_->stream_index = stream_->index;
        packet_->duration = 1;
        av_packet_rescale_ts(packet_, encoder_->time_base, stream_->time_base);
        if (Status status = check(av_interleaved_write_frame(format_, packet_), "writing"); !status) return status;
    }
}

Status Mp4Writer::add(const FrameImage& frame) {
    if (frame.width != options_.width || frame.height != options_.height ||
        frame.rgba.size() != size_t{4} * frame.width * frame.height) {
        return Error{path_ + ": a frame of another size than the film's"};
    }
    if (Status status = check(av_frame_make_writable(frame_), "frame buffer"); !status) return status;
    const uint8_t* rows[1] = {frame.rgba.data()};
    const int strides[1] = {static_cast<int>(frame.width * 4)};
    sws_scale(scaler_, rows, strides, 0, encoder_->height, frame_->data, frame_->linesize);
    frame_->pts = frames_++;
    return encode(frame_);
}

Status Mp4Writer::finish() {
    if (Status status = encode(nullptr); !status) return status;
    if (Status status = check(av_write_trailer(format_), "MP4 index"); !status) return status;
    return check(avio_closep(&format_->pb), "closing");
}

}  // namespace

Result<std::unique_ptr<VideoWriter>> VideoWriter::create(const std::string& path, const VideoOptions& options) {
    if (options.width < 2 || options.height < 2 || options.width > 16384 || options.height > 16384 ||
        options.frames_per_second == 0 || options.frames_per_second > 1000) {
        return Error{path + ": a film needs frames of 2..16384 pixels a side and 1..1000 frames a second"};
    }
    av_log_set_level(AV_LOG_ERROR);
    auto writer = std::make_unique<Mp4Writer>(path, options);
    if (const Status status = writer->open(); !status) return status.error();
    return std::unique_ptr<VideoWriter>(std::move(writer));
}

}  // namespace citystream::client
