#pragma once

#include <QPolygonF>
#include <QQuickPaintedItem>

#include "interaction/tablet/window/screen_model.hpp"

namespace usher::tablet {

/// Building, route, places and destination; painted only when one of them changes. The robot is an
/// item of its own, so that it can move without painting, and names lie above it.
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

 signals:
  void screenChanged();
  void textSizeChanged();

 private:
  QPolygonF route(double scale) const;
  void paint_route(QPainter* painter, const QPolygonF& route) const;
  void paint_places(QPainter* painter, double scale) const;

  ScreenModel* screen_ = nullptr;
  double text_size_ = 20.0;
};

}  // namespace usher::tablet
