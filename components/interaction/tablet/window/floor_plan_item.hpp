#pragma once

#include <QQuickPaintedItem>
#include <QRectF>
#include <vector>

#include "interaction/tablet/window/screen_model.hpp"

namespace usher::tablet {

/// Building, places, route and destination; painted only when one of them changes. The robot is an
/// item of its own, so that it can move without painting.
class FloorPlanItem : public QQuickPaintedItem {
  Q_OBJECT
  QML_ELEMENT
  Q_PROPERTY(usher::tablet::ScreenModel* screen READ screen WRITE set_screen NOTIFY screenChanged)
  Q_PROPERTY(double textSize MEMBER text_size_ NOTIFY textSizeChanged)

 public:
  explicit FloorPlanItem(QQuickItem* parent = nullptr);
  ScreenModel* screen() const { return screen_; }
  void set_screen(ScreenModel* screen);
  void paint(QPainter* painter) override;
  /// Where names of places were written last; they do not overlap.
  const std::vector<QRectF>& labels() const { return labels_; }

 signals:
  void screenChanged();
  void textSizeChanged();

 private:
  void paint_route(QPainter* painter, double scale) const;
  void paint_places(QPainter* painter, double scale);

  ScreenModel* screen_ = nullptr;
  double text_size_ = 20.0;
  std::vector<QRectF> labels_;
};

}  // namespace usher::tablet
